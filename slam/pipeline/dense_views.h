#pragma once

#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/geometry/rigid3.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// The keyframes of a reconstruction that have dense depth, in the world that `target_from_world`
/// leads to. Neighbours are those that see the same landmarks.
std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world);

/// How the cloud of a reconstruction is fused: voxels of a fixed size in metres where its first map
/// is in metres, else of a size that follows from the ranges.
DenseCloudOptions CloudOptionsFor(const Reconstruction& reconstruction, int num_threads);

}  // namespace orb360
