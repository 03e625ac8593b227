#pragma once

#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/materials.h"

namespace orb360::town {

/// The materials of woods and hills, besides those of towns.
struct LandscapeMaterials : Materials {
  MaterialId leaf_litter, moss, needle_floor, heath, trail;  ///< ground
  std::vector<MaterialId> rocks;                             ///< to be tinted
  std::vector<MaterialId> needles, ferns, grass_tufts, dry_tufts;
};

/// Paints every texture. The same seed gives the same materials.
LandscapeMaterials PaintLandscapeMaterials(const Random& random);

}  // namespace orb360::town
