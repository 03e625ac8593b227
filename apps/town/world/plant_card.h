#pragma once

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A card with the image of a part of a plant: the unit tile of a cut-out, v along it.
struct PlantCard {
  Vector3f root = {0, 0, 0};    ///< middle of its lower edge
  Vector3f along = {0, 0, 1};   ///< unit, from there
  Vector3f across = {1, 0, 0};  ///< unit, to its right
  float length = 1;             ///< metres
  float width = 1;              ///< metres
  float droop = 0;              ///< metres that its end hangs lower than it points
  Vector3f light = {0, 0, 1};   ///< unit normal by which it is lit
};

/// Adds a card that bends downward evenly.
void AddPlantCard(const PlantCard& card, MaterialId material, MeshBuilder& b);

}  // namespace orb360::town
