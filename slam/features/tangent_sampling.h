#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {

/// Position of the tangent plane of the sphere at one pixel within a band of an equirectangular
/// image.
///
/// A patch is described in tangent coordinates (a to the east, b to the south), in units of the
/// pixel at the equator. Its shape on the sphere, and therefore what is sampled, is the same at
/// every latitude and camera rotation. With alpha = k a, beta = k b, k = 2 pi / width, a point
/// seen from latitude phi is
///   forward = cos(phi) + beta sin(phi),   longitude = atan(alpha / forward),
///   latitude - phi = -atan((beta + e sin(phi)) / (1 + e cos(phi))),
///   e = sqrt(forward^2 + alpha^2) - forward.
/// Small patches use these to second order, larger ones use quotients, roots and arctangents as
/// series, if the error is at most kMaxError and no point lies more than kMaxColumns aside.
/// Otherwise the points are computed exactly.
struct TangentSampling {
  /// Largest distance of a patch's points from its centre, pixels of the level.
  static constexpr float kMaxRadius = 15.0f;
  /// Largest number of columns that inexact sampling reaches to either side. Exact sampling wraps.
  static constexpr int kMaxColumns = 26;
  static constexpr double kMaxError = 0.25;  // at kMaxRadius, pixels
  enum class Order : uint8_t { kSecond, kSeries, kExact };

  /// `u` is a column of the band, which is `band_width` wide, and `v` a row of the level.
  TangentSampling(const EquirectangularCamera& level, int band_width, int u, int v)
      : u_index(u), v_index(v), width(band_width), height(level.height()) {
    const double latitude = (v + 0.5 - level.cy()) / level.fy();
    const double angle_of_pixel = level.AngleOfPixels(1.0);
    const double compression = static_cast<double>(band_width) / level.width();
    const double cos_latitude = std::cos(latitude);
    const double reach = angle_of_pixel * kMaxRadius;
    const double w = reach * std::abs(std::tan(latitude));
    const double q = reach / cos_latitude / std::max(1.0 - w, 1e-3);  // tangent of the longitude
    const double scale = level.fx() * compression;
    // The first omitted terms. The product a b^2 is at most 0.4 of the radius' cube.
    const double second_error = scale * (0.4 * q * w * w + std::pow(q, 3) / 3.0);
    const double series_error = scale * (q * std::pow(w, 5) + std::pow(q, 7) / 7.0);
    const bool wraps = scale * q > kMaxColumns;
    order = wraps || series_error > kMaxError ? Order::kExact
            : second_error > kMaxError        ? Order::kSeries
                                              : Order::kSecond;
    k = static_cast<float>(angle_of_pixel);
    sine = static_cast<float>(std::sin(latitude));
    cosine = static_cast<float>(cos_latitude);
    fx = static_cast<float>(scale);
    fy = static_cast<float>(level.fy());
  }

  int u_index;  // the patch's centre
  int v_index;
  int width;  // of the band
  int height;
  Order order;
  float k;     // angle of a pixel at the equator, rad
  float sine;  // of the centre's latitude
  float cosine;
  float fx;  // pixels of the band per radian; fy is negative
  float fy;
};

}  // namespace orb360
