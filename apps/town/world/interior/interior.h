#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/world/interior/floor_plan.h"
#include "apps/town/world/interior/interior_materials.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// One storey of a building, furnished and lit, with what is seen from its windows.
struct Interior {
  FloorPlan plan;
  std::vector<Area>
      taken;  ///< floor under furniture, doors, pipes and low lamps; blocks not included
  Scenery scenery;
  bool are_lamps_on = true;  ///< in most rooms, although it may be day
};

/// Returns the kind of building of a seed.
BuildingKind KindOfInterior(uint64_t seed);

/// Builds the interior of a seed. The floor is level at z = 0.
Interior BuildInterior(uint64_t seed);
/// As above, of a given kind.
Interior BuildInterior(uint64_t seed, BuildingKind kind);
/// As above, from given materials.
Interior BuildInterior(uint64_t seed, BuildingKind kind, InteriorMaterials materials);

}  // namespace orb360::town
