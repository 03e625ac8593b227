#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Makes a broad-leaved tree at the origin, about 6 to 11 m tall, and taller by the `bole`, metres
/// of trunk without branches below its crown.
Mesh MakeTree(const Materials& materials, Random random, float bole = 0);

/// Makes a clipped hedge of unit length along x, centred at the origin: 0.8 m wide and 1.1 m high.
Mesh MakeBush(const Materials& materials, Random random);

}  // namespace orb360::town
