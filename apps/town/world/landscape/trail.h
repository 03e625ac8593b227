#pragma once

#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A closed footpath without crossings, about the origin.
class Trail {
 public:
  static constexpr float kHalfWidth = 0.6F;  ///< metres

  /// Draws a trail that is `radius` metres from the origin in the mean. Its bends are no tighter
  /// than `radius` / (1 + 4.1 `swing`).
  Trail(float radius, Random random, float swing = 1);

  /// Places about 0.25 m apart, counter-clockwise; the last is next to the first.
  const std::vector<Vector2f>& points() const { return points_; }
  float reach() const { return reach_; }  ///< the largest distance from the origin, metres
  float Length() const;                   ///< of one round, metres
  /// Returns the distance to the middle of the trail, metres.
  float Distance(const Vector2f& p) const;

 private:
  std::vector<Vector2f> points_;
  float reach_ = 0;
};

}  // namespace orb360::town
