#pragma once

#include <cmath>
#include <cstdint>

#include "slam/geometry/camera.h"

namespace orb360 {

/// Where the tangent plane of the sphere at one pixel lies in a band of an equirectangular image.
///
/// A patch is described in tangent coordinates (a to the east, b to the south), in units of the
/// pixel at the equator, so that its shape on the sphere, and with it what is sampled, is the same
/// at every latitude and camera rotation. To second order a point is at
///   du = c a / cos(lat) * (1 - k b tan(lat)),   dv = b + k a^2 tan(lat) / 2,   k = 2 pi / width,
/// c the band's compression (sphere_band.h). Where the third order exceeds half a pixel, or points
/// lie more than kMaxColumns aside, they are projected exactly. Single precision: the error stays
/// below 0.01 pixels.
struct TangentSampling {
  /// Points of a patch never lie farther than this from its centre, in pixels of the level.
  static constexpr float kMaxRadius = 15.0f;
  /// Columns that inexact sampling reaches at most to either side; exact sampling wraps.
  static constexpr int kMaxColumns = 26;

  /// `u`, `v`: column of the band, which is `band_width` wide, and row of the level.
  TangentSampling(const EquirectangularCamera& level, int band_width, int u, int v)
      : u_index(u), v_index(v), width(band_width), height(level.height()) {
    const double latitude = (v + 0.5 - level.cy()) / level.fy();
    const double angle_of_pixel = level.AngleOfPixels(1.0);
    const double compression = static_cast<double>(band_width) / level.width();
    const double cos_latitude = std::cos(latitude);
    // Of atan2(k a, cos + k b sin) the leading third-order term, a^3 k^2 / (3 cos^3).
    const double reach = angle_of_pixel * kMaxRadius / cos_latitude;
    const double third_order = kMaxRadius * compression / cos_latitude * reach * reach / 3.0;
    const double columns =
        kMaxRadius * compression / cos_latitude * (1.0 + reach * std::abs(std::sin(latitude)));
    exact = third_order > 0.5 || columns > kMaxColumns;
    k = static_cast<float>(angle_of_pixel);
    sine = static_cast<float>(std::sin(latitude));
    cosine = static_cast<float>(cos_latitude);
    east_scale = static_cast<float>(compression / cos_latitude);
    fx = static_cast<float>(level.fx() * compression);
    fy = static_cast<float>(level.fy());
  }

  int u_index;  // the patch's centre
  int v_index;
  int width;  // of the band
  int height;
  bool exact;
  float k;     // angle of a pixel at the equator, rad
  float sine;  // of the centre's latitude
  float cosine;
  float east_scale;  // columns of the band per unit to the east
  float fx;          // pixels of the band per radian; fy is negative
  float fy;
};

}  // namespace orb360
