#include "slam/pipeline/dense_views.h"

#include <algorithm>
#include <map>

namespace orb360 {
CovisibleViews::CovisibleViews(const Reconstruction& reconstruction,
                               const Rigid3& target_from_world,
                               const std::function<bool(int frame_index)>& is_view)
    : sees_the_same_(reconstruction.keyframes.size()), views_of_(reconstruction.keyframes.size()) {
  const std::vector<FramePose>& keyframes = reconstruction.keyframes;
  std::map<int, size_t> place_of;  // of keyframes, by frame index
  for (size_t i = 0; i < keyframes.size(); ++i) {
    place_of[keyframes[i].index] = i;
    sees_the_same_[i].push_back(i);
  }
  for (const CovisibleFrames& pair : reconstruction.covisibility) {
    sees_the_same_[pair.first].push_back(pair.second);
    sees_the_same_[pair.second].push_back(pair.first);
  }
  for (const FramePose& frame : reconstruction.frames) {
    if (frame.is_interpolated || !is_view(frame.index)) continue;
    keyframe_of_.push_back(place_of.at(frame.reference));
    views_of_[keyframe_of_.back()].push_back(views_.size());
    views_.push_back({.frame_index = frame.index,
                      .map = frame.map,
                      .world_from_camera = target_from_world * frame.world_from_camera,
                      .neighbours = {},
                      .timestamp = frame.timestamp});
  }
}

std::vector<size_t> CovisibleViews::NeighboursOf(size_t view) const {
  std::vector<size_t> neighbours;
  for (const size_t keyframe : sees_the_same_[keyframe_of_[view]]) {
    neighbours.insert(neighbours.end(), views_of_[keyframe].begin(), views_of_[keyframe].end());
  }
  std::ranges::sort(neighbours);
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
