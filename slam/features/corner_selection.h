#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/sphere_band.h"
#include "slam/features/sphere_pyramid.h"

namespace orb360 {

/// A local maximum of the FAST score in one band of one level, with its neighbours' scores.
struct Maximum {
  int x;  // pixel indices: column of the band, row of the level
  int y;
  uint8_t score, left, right, above, below;
  uint8_t cell;       // column of cells, of 32
  bool within_share;  // among the strongest of its cell and its band
};

/// The maxima of one band from which SelectCorners chooses.
struct BandMaxima {
  int width = 0;     // of the band, pixels
  double share = 0;  // of the sphere's solid angle
  std::vector<Maximum> maxima;
};

/// Finds the maxima of one band. `count` is how many corners the whole level is to have. Those with
/// mask 0 are left out (`mask` CV_8U of any size that covers the sphere, or empty).
BandMaxima FindMaxima(const PyramidLevel& level, const SphereBand& band, int count,
                      uint8_t min_score, const cv::Mat& mask);

/// A corner chosen.
struct Corner {
  int band;
  int x;  // pixel indices: column of the band, row of the level
  int y;
  uint8_t score;
  double u;  // sub-pixel position of the maximum on the level, continuous (first centre at 0.5)
  double v;
};

/// About `count` corners of a level, from all its bands. Zones of latitude get their share of the
/// solid angle. Within one the strongest win, but no band and no cell (a 32nd of a band) gets more
/// than four times its own share as long as others have corners; and what a zone lacks, others
/// take over. Ordered by row, then column.
///
/// Equal scores at the cut are all kept, so that the choice does not depend on the longitude and
/// the number may exceed the count slightly.
std::vector<Corner> SelectCorners(std::span<const BandMaxima> bands, int level_width, int count);

}  // namespace orb360
