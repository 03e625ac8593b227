#pragma once

#include <cstdint>

namespace orb360 {

/// What the fusion of a cloud did.
struct DenseCloudStatistics {
  int views = 0;
  std::int64_t consistent = 0;  // points, before they met in voxels
  double voxel_size = 0;       // world units
};

/// The same with the number of points in the file.
struct DenseCloudSummary {
  DenseCloudStatistics fusion;
  std::uint64_t points = 0;
};

}  // namespace orb360
