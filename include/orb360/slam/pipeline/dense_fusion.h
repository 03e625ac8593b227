#pragma once

#include <filesystem>

#include <orb360/slam/depth/dense_cloud_summary.h>
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

class DepthMapStore;

/// Fuses the depth of all views into one cloud (FuseCloud) and writes it as PLY
/// (SurfacePlyWriter), in the world to which `target_from_world` transforms. `depth_maps` are those
/// of the system that made the reconstruction. Throws UserError where the disk fails.
DenseCloudSummary WriteDenseCloud(const std::filesystem::path& path,
                                  const Reconstruction& reconstruction,
                                  const DepthMapStore& depth_maps, const Rigid3& target_from_world,
                                  int num_threads);

}  // namespace orb360
