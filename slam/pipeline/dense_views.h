#pragma once

#include <functional>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// The frames of a reconstruction that may get dense depth, and which of them see the same: those
/// whose reference keyframes are one, or see the same landmarks.
class CovisibleViews {
 public:
  /// Takes those frames for whose index `is_view` holds and whose own images have told their poses,
  /// with poses in the world to which `target_from_world` transforms.
  CovisibleViews(const Reconstruction& reconstruction, const Rigid3& target_from_world,
                 const std::function<bool(int frame_index)>& is_view);

  /// Ordered by frame, without neighbours.
  const std::vector<DenseView>& views() const { return views_; }
  /// Returns the views that see what a view sees, without itself: indices into views(), ordered.
  std::vector<size_t> NeighboursOf(size_t view) const;

 private:
  std::vector<DenseView> views_;
  std::vector<std::vector<size_t>> sees_the_same_;  ///< By keyframe, with itself: keyframes.
  std::vector<size_t> keyframe_of_;                 ///< By view: its reference keyframe.
  std::vector<std::vector<size_t>> views_of_;       ///< By keyframe: the views of keyframe_of_.
};

/// Returns all views of CovisibleViews with their neighbours.
std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world,
                                      const std::function<bool(int frame_index)>& is_view);

/// Returns how the cloud of a reconstruction is fused: with voxels of a fixed size in metres where
/// its first map is in metres, otherwise of a size that follows from the ranges.
DenseCloudOptions CloudOptionsFor(const Reconstruction& reconstruction, int num_threads);

}  // namespace orb360
