#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "slam/depth/dense_cloud.h"
#include "slam/depth/surface_point.h"
#include "slam/io/depth_map_store.h"

namespace orb360 {

/// Fuses the stored depth of `views` (FuseCloud) and writes the cloud (SurfacePlyWriter) in the
/// world of their poses. The options bound the memory for any number of views; the remaining voxels
/// are kept in a folder `PATH.voxels` meanwhile. `look`, if given, receives all points in pieces.
/// Throws UserError if the disk fails.
DenseCloudSummary WriteDenseCloud(
    const std::filesystem::path& path, const DepthMapStore& store, std::span<const DenseView> views,
    const DenseCloudOptions& options,
    const std::function<void(std::span<const SurfacePoint>)>& look = nullptr);

}  // namespace orb360
