#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/materials.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Makes a boulder about the origin, whose largest radius is about `radius` metres.
Mesh MakeRock(const Materials& materials, MaterialId material, float radius, Random random);

}  // namespace orb360::town
