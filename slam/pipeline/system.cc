#include <exception>

#include "slam/pipeline/pipeline.h"
#include <orb360/nn/base/option_schema.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {

System::System(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask) {
  ValidateOptions(options);
  pipeline_ = std::make_unique<Pipeline>(camera, options, mask);
}

System::~System() = default;

void System::LoadMap(const StoredMap& stored) { pipeline_->LoadMap(stored, false); }

void System::Localize(const StoredMap& stored) { pipeline_->LoadMap(stored, true); }

void System::EnableDepth(const std::filesystem::path& weights, const std::filesystem::path& folder,
                         const nn::Device& device) {
  pipeline_->EnableDepth(weights, folder, device);
}

void System::Watch(const std::function<void(const PresentState&)>& watcher) {
  pipeline_->Watch(watcher);
}

FrameReport System::Process(const Frame& frame) { return pipeline_->Process(frame); }

Reconstruction System::Finish(const Positions& positions) { return pipeline_->Finish(positions); }

std::span<const Map> System::maps() const { return pipeline_->atlas().maps(); }

std::span<const std::optional<KnownGround>> System::grounds() const {
  return pipeline_->atlas().grounds();
}

ViewDepthReport System::ComputeDepth(const Reconstruction& finished,
                                     const ViewDepthCallbacks& callbacks) {
  return pipeline_->ComputeDepth(finished, callbacks);
}

const DepthMapStore* System::depth_maps() const {
  const std::optional<DenseMapper>& dense = pipeline_->dense();
  if (!dense) return nullptr;
  if (dense->failure()) std::rethrow_exception(dense->failure());
  return &dense->depth_maps();
}

const DepthCompleter* System::depth_completer() const {
  const std::optional<DenseMapper>& dense = pipeline_->dense();
  return dense ? &dense->completer() : nullptr;
}

}  // namespace orb360
