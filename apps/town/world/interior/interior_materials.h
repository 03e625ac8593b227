#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/materials.h"

namespace orb360::town {

/// The materials of a building's inside, besides those of the town around it.
struct InteriorMaterials : Materials {
  MaterialId wall_paint, worn_paint, ceiling_panels, screed;
  MaterialId veneer;  ///< wood, to be tinted
  MaterialId plain;   ///< anything painted or moulded, to be tinted
  std::vector<MaterialId> wallpapers, planks, floor_tiles, wall_tiles, terrazzos, carpets;
  std::vector<MaterialId> cloths, books, cartons, pictures, screens;
};

/// Paints every texture. The same seed gives the same materials.
InteriorMaterials PaintInteriorMaterials(const Random& random);

}  // namespace orb360::town
