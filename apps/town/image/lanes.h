#pragma once

#include <array>

namespace orb360::town {

/// Number of rays and samples that are worked on together: what Embree traces as one packet.
inline constexpr int kLanes = 16;

/// A number of each lane, aligned for vectors.
struct alignas(64) Lanes : std::array<float, kLanes> {};

/// A vector or a linear colour of each lane.
struct Lanes3 {
  Lanes x;  ///< or red
  Lanes y;
  Lanes z;
};

}  // namespace orb360::town
