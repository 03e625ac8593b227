#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// Adds what lies flat on the carriageways besides the lines: manhole covers, drains along the
/// kerbs, mended pieces and trenches.
void AddRoadDetails(const StreetPlan& plan, Random random, MeshBuilder& builder);

}  // namespace orb360::town
