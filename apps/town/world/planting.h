#pragma once

#include <cstdint>
#include <span>

#include "apps/town/image/random.h"
#include "apps/town/world/town.h"

namespace orb360::town {

/// Models of plants.
struct Plants {
  std::span<const uint32_t> trees;
  std::span<const uint32_t> hedges;  ///< pieces, a metre long
  uint32_t bench = 0;
};

/// Plants trees in a row on medians, and a tree within a ring of hedge on the islands of
/// roundabouts.
void PlantIslands(const Plants& plants, Random random, Town* town);

/// Plants trees on the lawn and a hedge along the pavements except at the gates, and places benches
/// about the centre.
void PlantParks(const Plants& plants, Random random, Town* town);

}  // namespace orb360::town
