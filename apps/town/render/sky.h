#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A time of day and weather. Radiances are in units of the exposure, before tone mapping.
struct Light {
  std::string name;
  Vector3f to_sun = Vector3f::UnitZ();  ///< unit vector
  Vector3f sun = Vector3f::Zero();      ///< irradiance on a surface facing the sun, over pi
  Vector3f zenith = Vector3f::Zero();   ///< clear sky overhead
  Vector3f horizon = Vector3f::Zero();
  Vector3f ground = Vector3f::Zero();  ///< light thrown back by ground and walls
  float cloud_cover = 0.4F;            ///< 0 clear, 1 closed
  float haze = 900;                    ///< metres in which contrast falls to 1/e
};

/// "noon", "morning", "sunset" or "overcast"; the sun's compass direction is drawn from the seed.
/// Throws UserError for another name.
Light MakeLight(std::string_view name, uint64_t seed);

/// The sky as an image over the upper hemisphere, with clouds and the sun.
class Sky {
 public:
  Sky(const Light& light, uint64_t seed);

  /// Radiance from a unit direction; below the horizon, the haze.
  Vector3f Radiance(const Vector3f& direction) const;
  /// Mean radiance over the upper hemisphere, weighted as by a horizontal surface.
  const Vector3f& mean() const { return mean_; }

 private:
  Vector3f Compute(const Vector3f& direction, const Light& light, uint32_t seed) const;

  std::vector<Eigen::Vector4f> texels_;  // octahedral map of the hemisphere; the fourth is unused
  Vector3f mean_ = Vector3f::Zero();
};

}  // namespace orb360::town
