#pragma once

#include <cstdint>

namespace orb360 {

/// Statistics of the fusion of depth maps into a cloud.
struct DenseCloudStatistics {
  int views = 0;  ///< Number of views whose depth was fused.
  /// Number of pixels whose points were geometrically consistent, before fusion in voxels.
  std::int64_t consistent = 0;
  double voxel_size = 0;  ///< Side of the voxels, world units.
};

/// Summary of a cloud that was written to a file.
struct DenseCloudSummary {
  DenseCloudStatistics fusion;  ///< Statistics of the fusion.
  std::uint64_t points = 0;     ///< Number of points in the file.
};

}  // namespace orb360
