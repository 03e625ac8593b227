#pragma once

#include <array>
#include <vector>

namespace orb360 {

/// The points that a descriptor compares, in tangent coordinates. Bit i is set if the first point
/// of pair i is darker than the second.
struct ComparisonPattern {
  static constexpr int kPairs = 256;
  std::array<float, kPairs> first_east, first_south, second_east, second_south;
};
const ComparisonPattern& DescriptorPattern();

/// The points whose intensities determine the orientation: every second pixel of the disc (the blur
/// is wider than that), padded with points at its centre to a multiple of 64.
struct MomentPattern {
  std::vector<float> east, south;
};
const MomentPattern& OrientationPattern();

}  // namespace orb360
