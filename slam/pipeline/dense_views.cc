#include "slam/pipeline/dense_views.h"

#include <algorithm>
#include <set>

namespace orb360 {
namespace {

/// The keyframes of a frame's map between which the frame lies, or itself if it is one: indices
/// into Reconstruction::keyframes. `of_map`: those of its map, ordered.
std::vector<size_t> KeyframesAround(const FramePose& frame, std::span<const FramePose> keyframes,
                                    const std::vector<size_t>& of_map) {
  const auto index_of = [&](size_t keyframe) { return keyframes[keyframe].index; };
  const auto after = std::ranges::lower_bound(of_map, frame.index, {}, index_of);
  if (after != of_map.end() && index_of(*after) == frame.index) return {*after};
  std::vector<size_t> around;
  if (after != of_map.begin()) around.push_back(*std::prev(after));
  if (after != of_map.end()) around.push_back(*after);
  return around;
}

}  // namespace

CovisibleViews::CovisibleViews(const Reconstruction& reconstruction,
                               const Rigid3& target_from_world,
                               const std::function<bool(int frame_index)>& is_view)
    : sees_the_same_(reconstruction.keyframes.size()), views_at_(reconstruction.keyframes.size()) {
  const std::vector<FramePose>& keyframes = reconstruction.keyframes;
  std::vector<std::vector<size_t>> of_map(reconstruction.maps.size());
  for (size_t i = 0; i < keyframes.size(); ++i) {
    of_map[keyframes[i].map].push_back(i);
    sees_the_same_[i].push_back(i);
  }
  for (const CovisibleFrames& pair : reconstruction.covisibility) {
    sees_the_same_[pair.first].push_back(pair.second);
    sees_the_same_[pair.second].push_back(pair.first);
  }
  for (const FramePose& frame : reconstruction.frames) {
    if (frame.is_interpolated || !is_view(frame.index)) continue;
    keyframes_at_.push_back(KeyframesAround(frame, keyframes, of_map[frame.map]));
    for (const size_t keyframe : keyframes_at_.back()) views_at_[keyframe].push_back(views_.size());
    views_.push_back({.frame_index = frame.index,
                      .map = frame.map,
                      .world_from_camera = target_from_world * frame.world_from_camera,
                      .neighbours = {}});
  }
}

std::vector<size_t> CovisibleViews::NeighboursOf(size_t view) const {
  std::set<size_t> keyframes;
  for (const size_t keyframe : keyframes_at_[view]) {
    keyframes.insert(sees_the_same_[keyframe].begin(), sees_the_same_[keyframe].end());
  }
  std::vector<size_t> neighbours;
  for (const size_t keyframe : keyframes) {
    neighbours.insert(neighbours.end(), views_at_[keyframe].begin(), views_at_[keyframe].end());
  }
  std::ranges::sort(neighbours);
  const auto repeated = std::ranges::unique(neighbours);
  neighbours.erase(repeated.begin(), repeated.end());
  std::erase(neighbours, view);
  return neighbours;
}

std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world,
                                      const std::function<bool(int frame_index)>& is_view) {
  const CovisibleViews covisible(reconstruction, target_from_world, is_view);
  std::vector<DenseView> views = covisible.views();
  for (size_t i = 0; i < views.size(); ++i) views[i].neighbours = covisible.NeighboursOf(i);
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
