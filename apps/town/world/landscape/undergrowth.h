#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/landscape/landscape_materials.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Makes a fern at the origin, up to 0.9 m high.
Mesh MakeFern(const LandscapeMaterials& materials, Random random);

/// Makes tufts of grass within half a metre of the origin, up to 0.7 m high.
Mesh MakeGrass(const LandscapeMaterials& materials, bool is_dry, Random random);

/// Makes a broad-leaved bush at the origin, 0.7 to 1.8 m high.
Mesh MakeShrub(const LandscapeMaterials& materials, Random random);

/// Makes a fallen trunk on the ground along x, 3 to 7 m long, with stumps of branches.
Mesh MakeFallenTrunk(const LandscapeMaterials& materials, Random random);

}  // namespace orb360::town
