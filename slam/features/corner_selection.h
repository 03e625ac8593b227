#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/sphere_band.h"
#include "slam/features/sphere_pyramid.h"

namespace orb360 {

/// A local maximum of the FAST score in one band of one level, with the scores of its neighbours.
struct Maximum {
  int x;  // pixel indices: column of the band, row of the level
  int y;
  uint8_t score, left, right, above, below;
  uint8_t cell;       // column of cells, of 32
  bool within_quota;  // among the strongest of its cell and its band
};

/// The maxima of one band from which SelectCorners chooses.
struct BandMaxima {
  int width = 0;        // of the band, pixels
  double fraction = 0;  // of the sphere's solid angle
  std::vector<Maximum> maxima;
};

/// Finds the maxima of one band. `count` is the number of corners that the whole level should have.
/// Maxima with mask 0 are left out (`mask` is CV_8U, of any size that covers the sphere, or empty).
BandMaxima FindMaxima(const PyramidLevel& level, const SphereBand& band, int count,
                      uint8_t min_score, const cv::Mat& mask);

/// A selected corner.
struct Corner {
  int band;
  int x;  // pixel indices: column of the band, row of the level
  int y;
  uint8_t score;
  double u;  // sub-pixel position of the maximum on the level, continuous (first centre at 0.5)
  double v;
};

/// Selects about `count` corners of a level from all its bands. Each zone of latitude gets a number
/// in proportion to its solid angle. Within a zone the strongest corners are selected, but no band
/// and no cell (a 32nd of a band) gets more than four times its even quota while others have
/// corners left. Corners that a zone lacks are taken from other zones. The result is ordered by
/// row, then column.
///
/// All corners of equal score at the cut are kept, so that the choice does not depend on the
/// longitude. Their number may therefore exceed the count slightly.
std::vector<Corner> SelectCorners(std::span<const BandMaxima> bands, int level_width, int count);

}  // namespace orb360
