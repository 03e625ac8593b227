#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

inline constexpr uint32_t kPedalPhases = 8;         ///< still images of one turn of the pedals
inline constexpr double kMetresPerPedalTurn = 4.6;  ///< of the road
inline constexpr double kBicycleLength = 1.75;      ///< metres
inline constexpr double kHandlebarWidth = 0.56;     ///< metres

/// Makes a person on a bicycle with the pedals in one of kPedalPhases: x forward, the origin on the
/// road halfway between the wheels. The frame takes the tint of the instance. The same state of
/// `random` gives the same person.
Mesh MakeCyclist(uint32_t phase, const Materials& materials, Random random);

}  // namespace orb360::town
