#pragma once

#include <cmath>
#include <cstdint>

#include "slam/geometry/camera.h"

namespace orb360 {

/// Where the tangent plane of the sphere at one pixel lies in an equirectangular image.
///
/// A patch is described in tangent coordinates (a to the east, b to the south), in units of the
/// pixel at the equator, so that its shape on the sphere, and with it what is sampled, is the same
/// at every latitude and camera rotation. To second order a point is at
///   du = a / cos(lat) * (1 - k b tan(lat)),   dv = b + k a^2 tan(lat) / 2,   k = 2 pi / width,
/// which up to kExactLatitude is within half a pixel for patches of radius kMaxRadius; nearer to
/// the poles points are projected exactly. Single precision: the error stays below 0.01 pixels.
struct TangentSampling {
  /// Points of a patch never lie farther than this from its centre, in pixels of the level.
  static constexpr float kMaxRadius = 15.0f;
  /// 70 degrees: up to here du <= 15 / cos * (1 + k 15 tan) < 64 for images from 512 pixels on.
  static constexpr double kExactLatitude = 1.22;

  TangentSampling(const EquirectangularCamera& camera, int u, int v)
      : u_index(u), v_index(v), width(camera.width()), height(camera.height()) {
    const double latitude = (v + 0.5 - camera.cy()) / camera.fy();
    exact = std::abs(latitude) > kExactLatitude;
    k = static_cast<float>(camera.AngleOfPixels(1.0));
    sine = static_cast<float>(std::sin(latitude));
    cosine = static_cast<float>(std::cos(latitude));
    fx = static_cast<float>(camera.fx());
    fy = static_cast<float>(camera.fy());
  }

  int u_index;  // the patch's centre
  int v_index;
  int width;
  int height;
  bool exact;
  float k;     // angle of a pixel at the equator, rad
  float sine;  // of the centre's latitude
  float cosine;
  float fx;  // the camera's, pixels per radian; fy is negative
  float fy;
};

}  // namespace orb360
