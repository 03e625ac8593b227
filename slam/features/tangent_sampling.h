#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "slam/features/sphere_pyramid.h"

namespace orb360 {

/// Where the tangent plane of the sphere at one latitude lies in an equirectangular image.
///
/// A patch is described in tangent coordinates (a to the east, b to the south), in units of the
/// pixel at the equator, so that its shape on the sphere, and with it what is sampled, is the same
/// at every latitude and camera rotation. To second order a point is at
///   du = a / cos(lat) * (1 - k b tan(lat)),   dv = b + k a^2 tan(lat) / 2,   k = 2 pi / width,
/// which up to kExactLatitude is within half a pixel for patches of radius 15; nearer to the poles
/// points are projected exactly.
class TangentSampling {
 public:
  /// Points of a patch never lie farther than this from its centre, in pixels of the level.
  static constexpr float kMaxRadius = 15.5f;
  static constexpr double kExactLatitude = 1.22;  // rad (70 deg): du <= 15.5 / cos < 46 px

  /// For the row of pixels `v` (continuous) of a level.
  TangentSampling(const EquirectangularCamera& camera, double v)
      : camera_(&camera),
        latitude_((v - camera.cy()) / camera.fy()),
        exact_(std::abs(latitude_) > kExactLatitude),
        k_(static_cast<float>(camera.AngleOfPixels(1.0))),
        inverse_cosine_(static_cast<float>(1.0 / std::cos(latitude_))),
        tangent_(static_cast<float>(std::tan(latitude_))),
        vertical_(static_cast<float>(-camera.fy() / camera.fx())) {}

  /// Offsets in elements, from the pixel at the patch's centre, of the pixels nearest to the
  /// points (a[i], b[i]); `stride` is that of a padded level and all offsets stay inside it.
  /// `u_index`, `v_index`: the centre's pixel indices.
  void Offsets(std::span<const float> a, std::span<const float> b, int u_index, int v_index,
               ptrdiff_t stride, int32_t* offsets) const;

 private:
  const EquirectangularCamera* camera_;
  double latitude_;
  bool exact_;
  float k_;
  float inverse_cosine_;
  float tangent_;
  float vertical_;
};

}  // namespace orb360
