#include "slam/pipeline/dense_views.h"

namespace orb360 {

std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world,
                                      const std::function<bool(int frame_index)>& is_view) {
  const std::vector<FramePose>& keyframes = reconstruction.keyframes;
  std::vector<DenseView> views;
  constexpr size_t kNone = static_cast<size_t>(-1);
  std::vector<size_t> view_of(keyframes.size(), kNone);
  for (size_t i = 0; i < keyframes.size(); ++i) {
    if (!is_view(keyframes[i].index)) continue;
    view_of[i] = views.size();
    views.push_back({.frame_index = keyframes[i].index,
                     .map = keyframes[i].map,
                     .world_from_camera = target_from_world * keyframes[i].world_from_camera,
                     .neighbours = {}});
  }
  for (const CovisibleFrames& pair : reconstruction.covisibility) {
    const size_t first = view_of[pair.first];
    const size_t second = view_of[pair.second];
    if (first == kNone || second == kNone) continue;
    views[first].neighbours.push_back(second);
    views[second].neighbours.push_back(first);
  }
  return views;
}

DenseCloudOptions CloudOptionsFor(const Reconstruction& reconstruction, int num_threads) {
  DenseCloudOptions options;
  options.num_threads = num_threads;
  if (!reconstruction.maps.empty() && !reconstruction.maps.front().is_metric) {
    options.voxel_size.reset();
  }
  return options;
}

}  // namespace orb360
