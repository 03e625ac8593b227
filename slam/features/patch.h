#pragma once

#include <array>
#include <cstdint>

namespace orb360 {

/// Gray values around a point, on a square grid.
struct Patch {
  /// Samples on each side of the centre that are compared; one more is kept for their gradient.
  static constexpr int kRadius = 5;
  static constexpr int kWidth = 2 * kRadius + 3;
  std::array<uint8_t, kWidth * kWidth> gray;  // row by row
};

}  // namespace orb360
