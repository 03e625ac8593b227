#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/row_resample.h"
#include "slam/features/sphere_pyramid.h"

namespace orb360 {

/// Number of bands of latitude of equal height on every level. A band is 11.25 degrees high, so
/// that a 32nd of it is about square at the equator.
inline constexpr int kSphereBands = 16;

/// A band of one level, compressed horizontally to about the proportions that it has on the sphere.
/// Near the poles an equirectangular image is stretched by 1 / cos(latitude), so both the detection
/// of corners and the effect of a blur would depend on the direction.
///
/// The width is a multiple of kSphereColumns, so that a roll of the level by whole cells is one of
/// the band. The margin is that of a level (sphere_pyramid.h): rows beyond the band, and columns
/// that wrap. Below 45 degrees the compression would be slight, and the band is a view of the
/// level.
struct SphereBand {
  int y_begin;  // rows of the level: [y_begin, y_end)
  int y_end;
  int width;
  int first_row;                          // the level's row that is row 0 of `padded`
  std::vector<ResampleTaps> compression;  // from the level's width to the band's, one after another
  cv::Mat padded;                         // CV_8U, width + 2 PyramidLevel::kMarginX columns

  ptrdiff_t stride() const { return static_cast<ptrdiff_t>(padded.step); }
  /// Returns the pixel at column x of the band and row y of the level.
  const uint8_t* Pixel(int x, int y) const {
    return padded.ptr(y - first_row) + PyramidLevel::kMarginX + x;
  }
};

/// Cuts band `index`, counted from the top, from a level. `band` may hold the same band of an
/// earlier image; its memory is reused.
void CutBand(const PyramidLevel& level, int index, SphereBand* band);

/// Blurs band `index` for the comparison of single pixels (blur.h), including its margin except for
/// the outermost 3 pixels. `whole` is memory of the size of the level's `padded`, the same for all
/// bands of a level; bands that are views of their level become views of it.
void BlurBand(int index, const SphereBand& band, cv::Mat* whole, SphereBand* blurred);

}  // namespace orb360
