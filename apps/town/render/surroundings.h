#pragma once

#include <array>
#include <cstdint>

#include "apps/town/render/sky.h"

namespace orb360::town {

/// The surroundings that panes and car bodies mirror: the sky above an invented row of houses all
/// around, and the street below. They are the same for every mirror, which is not noticeable, and
/// cost a look-up in place of a ray.
class Surroundings {
 public:
  Surroundings(const Light& light, const Sky& sky, uint64_t seed);

  /// Returns the radiance from a unit direction.
  Vector3f Radiance(const Vector3f& direction) const;

 private:
  struct House {
    float height = 0;  ///< sine of the elevation of its eaves
    Vector3f radiance = Vector3f::Zero();
  };
  static constexpr size_t kColumns = 512;

  const Sky* sky_;
  Vector3f ground_;
  std::array<House, kColumns> houses_;  ///< by ColumnOf
};

}  // namespace orb360::town
