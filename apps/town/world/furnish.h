#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/town.h"

namespace orb360::town {

/// Adds the models of street furniture, trees and vehicles to the town and places them along its
/// streets: parked cars by the kerb, the rest on the pavements.
void FurnishStreets(const Random& random, const Materials& materials, Town* town);

}  // namespace orb360::town
