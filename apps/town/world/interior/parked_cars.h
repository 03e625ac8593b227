#pragma once

#include "apps/town/world/interior/placement.h"

namespace orb360::town {

/// Marks bays along both long walls of a garage, in wide ones in its middle too, and parks cars in
/// some of them.
void ParkCars(Placement& placement);

}  // namespace orb360::town
