#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/world/scenery.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// A procedural town.
struct Town {
  Scenery scenery;
  StreetPlan plan;
  std::vector<uint32_t> vehicles;     ///< the models by VehicleKind
  std::vector<uint32_t> pedestrians;  ///< the first of kWalkPhases models of each person
  std::vector<uint32_t> cyclists;     ///< the first of kPedalPhases models of each person
};

/// Plans the streets of the town of a seed; the plan's own seed is drawn from it.
StreetPlan PlanTown(uint64_t seed, PlanOptions plan = {});

/// Builds the town of a seed; the plan's own seed is drawn from it.
Town BuildTown(uint64_t seed, PlanOptions plan = {});

}  // namespace orb360::town
