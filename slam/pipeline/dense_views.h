#pragma once

#include <functional>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// Returns those frames of a reconstruction for whose index `is_view` holds and whose own images
/// have told their poses, with poses in the world to which `target_from_world` transforms. Frames
/// at or between keyframes that see the same landmarks are neighbours.
std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world,
                                      const std::function<bool(int frame_index)>& is_view);

/// Returns how the cloud of a reconstruction is fused: with voxels of a fixed size in metres where
/// its first map is in metres, otherwise of a size that follows from the ranges.
DenseCloudOptions CloudOptionsFor(const Reconstruction& reconstruction, int num_threads);

}  // namespace orb360
