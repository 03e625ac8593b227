#pragma once

#include <filesystem>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/dense_cloud_file.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// Returns the keyframes of a reconstruction that have dense depth, with poses in the world to
/// which `target_from_world` transforms. Keyframes that see the same landmarks are neighbours.
std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world);

/// Returns how the cloud of a reconstruction is fused: with voxels of a fixed size in metres where
/// its first map is in metres, otherwise of a size that follows from the ranges.
DenseCloudOptions CloudOptionsFor(const Reconstruction& reconstruction, int num_threads);

/// Fuses the depth of all keyframes into one cloud (FuseCloud) and writes it as PLY
/// (SurfacePlyWriter), in the world to which `target_from_world` transforms. `depth_maps` are those
/// of the system that made the reconstruction. Throws UserError where the disk fails.
DenseCloudSummary WriteDenseCloud(const std::filesystem::path& path,
                                  const Reconstruction& reconstruction,
                                  const DepthMapStore& depth_maps, const Rigid3& target_from_world,
                                  int num_threads);

}  // namespace orb360
