#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/sphere_pyramid.h"

namespace orb360 {

/// A local maximum of the FAST score on one level.
struct Corner {
  int x;  // pixel indices on the level
  int y;
  uint8_t score;
  float dx;  // sub-pixel position of the maximum relative to the pixel's centre, in [-0.5, 0.5]
  float dy;
};

/// Corners of each level, about counts[level] of them, shared out over the sphere by solid angle:
/// bands of latitude get their share, and within a band 32 cells side by side contribute their
/// strongest. What a band lacks, others with corners to spare take over. Corners with mask 0 are
/// left out (`mask` CV_8U of any size that covers the sphere, or empty). Ordered by row, then
/// column.
///
/// Equal scores at the cut are all kept, so that the choice does not depend on the longitude and
/// the number may exceed the count slightly.
std::vector<std::vector<Corner>> SelectCorners(const std::vector<PyramidLevel>& levels,
                                               const std::vector<int>& counts, uint8_t min_score,
                                               const cv::Mat& mask);

}  // namespace orb360
