#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "apps/town/drive/track.h"

namespace orb360::town {

/// A vehicle's rectangle on the road.
struct Outline {
  Vector2d middle;
  Vector2d forward;
  Footprint size;

  std::array<Vector2d, 4> Corners() const {
    const Vector2d x = 0.5 * size.length * forward;
    const Vector2d y = 0.5 * size.width * Vector2d(-forward.y(), forward.x());
    return {Vector2d(middle + x + y), Vector2d(middle + x - y), Vector2d(middle - x - y),
            Vector2d(middle - x + y)};
  }
};

/// Whether two rectangles overlap: no axis of either parts them.
inline bool Overlap(const Outline& a, const Outline& b) {
  const auto parts = [](const Outline& r, const Outline& other) {
    const Vector2d left(-r.forward.y(), r.forward.x());
    for (const auto& [axis, half] :
         {std::pair(r.forward, 0.5 * r.size.length), std::pair(left, 0.5 * r.size.width)}) {
      double low = 1e30;
      double high = -1e30;
      for (const Vector2d& corner : other.Corners()) {
        low = std::min(low, (corner - r.middle).dot(axis));
        high = std::max(high, (corner - r.middle).dot(axis));
      }
      if (low > half || high < -half) return true;
    }
    return false;
  };
  return !parts(a, b) && !parts(b, a);
}

}  // namespace orb360::town
