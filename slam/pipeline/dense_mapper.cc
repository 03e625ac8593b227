#include "slam/pipeline/dense_mapper.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "slam/depth/ground_probability.h"
#include "slam/pipeline/dense_views.h"
#include "slam/pipeline/view_depth.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

ViewDepthOptions ViewDepthOptionsOf(const DepthOptions& options, const MetricScale& scale) {
  ViewDepthOptions result{.spacing = options.view_spacing,
                          .min_points = options.min_points,
                          .keeps_completed = options.completion};
  if (!options.stereo) result.baselines.clear();
  if (scale.state != ScaleState::kUnknown && scale.value > 0) {
    result.camera_height = scale.camera_height / scale.value;
  }
  return result;
}

namespace {

/// Both and the maps must outlive the result.
LandmarkProjector ProjectorOf(const Reconstruction& finished, std::span<const Map> maps,
                              const EquirectangularCamera& camera) {
  std::vector<std::map<int, KeyframeId>> id_of(maps.size());  // by frame index
  for (size_t m = 0; m < maps.size(); ++m) {
    for (const KeyframeId id : maps[m].KeyframeIds()) {
      id_of[m][maps[m].keyframe(id).frame_index] = id;
    }
  }
  return [&finished, maps, &camera, id_of = std::move(id_of)](const DenseView& view) {
    const int reference =
        std::ranges::lower_bound(finished.frames, view.frame_index, {}, &FramePose::index)
            ->reference;
    return ProjectLandmarks(maps[view.map], id_of[view.map].at(reference), view.world_from_camera,
                            camera, {});
  };
}

}  // namespace

DenseMapper::DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
                         const DepthOptions& options, int num_threads, const nn::Device& device)
    : folder_(folder),
      options_(options),
      num_threads_(num_threads),
      depth_maps_(folder),
      completer_(
          weights,
          {.size = {2 * options.height, options.height}, .threads = num_threads, .device = device}),
      images_(folder / "images", {camera().width(), camera().height()}, options.stereo),
      completion_(&completer_, options) {}

void DenseMapper::Flush() {
  images_.Flush();
  completion_.Drop();
}

ViewDepthReport DenseMapper::ComputeDepth(const Reconstruction& finished, std::span<const Map> maps,
                                          const ViewDepthCallbacks& callbacks) {
  if (failure()) return {};
  const CovisibleViews covisible(finished, Rigid3(),
                                 [this](int index) { return images_.store().Contains(index); });
  const auto neighbours_of = [&](size_t view) { return covisible.NeighboursOf(view); };
  const LandmarkProjector landmarks_of = ProjectorOf(finished, maps, camera());
  const ViewDepthOptions options = ViewDepthOptionsOf(options_, finished.scale);
  try {
    const DepthMapStore first(folder_ / "first");
    return orb360::ComputeDepth(covisible.views(), neighbours_of, landmarks_of, finished.up,
                                options, images_.store(), &completer_, num_threads_, first,
                                depth_maps_, callbacks);
  } catch (const UserError&) {
    images_.Clear();
    throw;
  }
}

std::optional<double> DenseMapper::GroundProbability(const Reconstruction& finished,
                                                     std::span<const Map> maps,
                                                     const Eigen::Vector3d& up) {
  constexpr size_t kViews = 9;
  if (failure()) return std::nullopt;
  const CovisibleViews covisible(finished, Rigid3(),
                                 [this](int index) { return images_.store().Contains(index); });
  const std::vector<DenseView>& views = covisible.views();
  const LandmarkProjector landmarks_of = ProjectorOf(finished, maps, camera());
  const size_t count = std::min(kViews, views.size());
  std::vector<double> means;
  for (size_t k = 0; k < count; ++k) {
    const DenseView& view = views[(2 * k + 1) * views.size() / (2 * count)];
    const std::vector<SparsePoint> points = landmarks_of(view);
    if (static_cast<int>(points.size()) < options_.min_points) continue;
    const DenseDepth depth = completer_.Complete(images_.store().Get(view.frame_index),
                                                 RenderSparseDepth(points, camera()));
    const Eigen::Vector3d up_in_camera = view.world_from_camera.rotation.inverse() * up;
    if (const auto mean = MeanGroundProbability(depth, up_in_camera)) means.push_back(*mean);
  }
  if (means.empty()) return std::nullopt;
  std::ranges::nth_element(means, means.begin() + static_cast<int>(means.size() / 2));
  return means[means.size() / 2];
}

std::optional<KnownGround> DenseMapper::Ground() const {
  constexpr size_t kEnough = 10;      // keyframes
  constexpr double kMaxSigma = 0.05;  // standard deviation of ln(height)
  if (grounds_.size() < kEnough) return std::nullopt;
  const DenseGround fused = FuseGrounds(grounds_).value();
  if (fused.sigma > kMaxSigma) return std::nullopt;
  return KnownGround{.up = fused.up, .camera_height = std::exp(fused.log_height), .is_rough = true};
}

}  // namespace orb360
