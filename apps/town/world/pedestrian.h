#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

inline constexpr uint32_t kWalkPhases = 12;    ///< still images of one stride
inline constexpr double kStrideLength = 1.45;  ///< metres, two steps

/// Makes a walking person in one of kWalkPhases: x forward, the origin between the feet. The same
/// state of `random` gives the same person.
Mesh MakePedestrian(uint32_t phase, const Materials& materials, Random random);

}  // namespace orb360::town
