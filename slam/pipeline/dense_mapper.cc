#include "slam/pipeline/dense_mapper.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "slam/pipeline/dense_views.h"
#include "slam/pipeline/keyframe_depth.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

DenseMapper::DenseMapper(const std::filesystem::path& weights, const std::filesystem::path& folder,
                         const DepthOptions& options, int num_threads)
    : options_(options),
      num_threads_(num_threads),
      depth_maps_(folder),
      completer_(weights, {.size = {2 * options.height, options.height}, .threads = num_threads}),
      images_(folder / "images", {camera().width(), camera().height()}, options.stereo),
      completion_(&completer_, options) {}

void DenseMapper::Flush() {
  images_.Flush();
  completion_.Drop();
}

KeyframeDepthReport DenseMapper::ComputeDepth(const Reconstruction& finished,
                                              std::span<const Map> maps,
                                              const KeyframeProgress& progress) {
  if (failure()) return {};
  std::vector<std::map<int, KeyframeId>> id_of(maps.size());  // by frame index
  std::set<int> wanted;
  for (size_t m = 0; m < maps.size(); ++m) {
    for (const KeyframeId id : maps[m].KeyframeIds()) {
      const int frame_index = maps[m].keyframe(id).frame_index;
      id_of[m][frame_index] = id;
      // Ids change where maps are merged. The first keyframes of a map are kept by no KeepKeyframe.
      const bool is_wanted = options_.every_keyframes == 1 ||
                             std::ranges::binary_search(images_.keyframes(), frame_index);
      if (is_wanted && images_.store().Contains(frame_index)) wanted.insert(frame_index);
    }
  }
  const std::vector<DenseView> views =
      MakeDenseViews(finished, Rigid3(), [&wanted](int index) { return wanted.contains(index); });
  std::vector<FramePose> frames;
  if (options_.stereo) {
    std::ranges::copy_if(
        finished.frames, std::back_inserter(frames),
        [this](const FramePose& frame) { return images_.store().Contains(frame.index); });
  }
  const auto landmarks_of = [&](const DenseView& view) {
    return ProjectLandmarks(maps[view.map], id_of[view.map].at(view.frame_index), camera(), {});
  };
  KeyframeDepthOptions options{.min_points = options_.min_points,
                               .keeps_completed = options_.completion};
  if (!options_.stereo) options.baselines.clear();
  try {
    return orb360::ComputeDepth(views, frames, landmarks_of, options, images_.store(), &completer_,
                                num_threads_, depth_maps_, progress);
  } catch (const UserError&) {
    images_.Clear();
    throw;
  }
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
