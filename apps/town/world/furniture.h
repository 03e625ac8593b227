#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Street furniture standing at the origin, x towards the carriageway.
Mesh MakeLampPost(const Materials& materials, Random random);
Mesh MakeTrafficLight(const Materials& materials);
Mesh MakeRoadSign(const Materials& materials, Random random);
Mesh MakeBench(const Materials& materials);
Mesh MakeBin(const Materials& materials);
Mesh MakeBollard(const Materials& materials);

}  // namespace orb360::town
