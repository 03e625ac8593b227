#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/landscape/landscape_materials.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// The shape of a conifer, metres.
struct ConiferShape {
  float height = 14;
  float crown_base = 3;  ///< height of the lowest green branches; dead ones are below
  float spread = 2.5F;   ///< length of the longest branches
  float radius = 0.16F;  ///< of the trunk at its foot
};

/// Makes a conifer at the origin.
Mesh MakeConifer(const LandscapeMaterials& materials, const ConiferShape& shape, Random random);

}  // namespace orb360::town
