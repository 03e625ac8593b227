#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A broad-leaved tree of some species standing at the origin, about 6 to 11 m tall.
Mesh MakeTree(const Materials& materials, Random random);

}  // namespace orb360::town
