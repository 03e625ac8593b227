#pragma once

#include <filesystem>
#include <vector>

#include "slam/depth/dense_cloud.h"
#include "slam/io/dense_cloud_file.h"
#include "slam/pipeline/reconstruction.h"

namespace orb360 {

/// The keyframes of a reconstruction that have dense depth, in the world that `target_from_world`
/// leads to. Neighbours are those that see the same landmarks.
std::vector<DenseView> MakeDenseViews(const Reconstruction& reconstruction,
                                      const Rigid3& target_from_world);

/// How the cloud of a reconstruction is fused: voxels of a fixed size in metres where its first map
/// is in metres, else of a size that follows from the ranges.
DenseCloudOptions CloudOptionsFor(const Reconstruction& reconstruction, int num_threads);

/// Fuses the depth of all keyframes into one cloud (FuseCloud) and writes it as PLY
/// (SurfacePlyWriter), in the world that `target_from_world` leads to. `depth_maps`: of the system
/// that made the reconstruction. Throws UserError where the disk fails.
DenseCloudSummary WriteDenseCloud(const std::filesystem::path& path,
                                  const Reconstruction& reconstruction,
                                  const DepthMapStore& depth_maps, const Rigid3& target_from_world,
                                  int num_threads);

}  // namespace orb360
