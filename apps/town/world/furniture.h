#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Street furniture at the origin, x towards the carriageway.
Mesh MakeLampPost(const Materials& materials, Random random);
Mesh MakeTrafficLight(const Materials& materials);
Mesh MakeRoadSign(const Materials& materials, Random random);
Mesh MakeBench(const Materials& materials);
Mesh MakeBin(const Materials& materials);
Mesh MakeBollard(const Materials& materials);
Mesh MakePostBox(const Materials& materials);
Mesh MakeHydrant(const Materials& materials);
/// A cabinet of the telephone or electricity company, with bills stuck on it.
Mesh MakeCabinet(const Materials& materials, Random random);
/// A column covered with posters, 3.4 m high.
Mesh MakeAdvertisingColumn(const Materials& materials, Random random);
/// A bus shelter, 3.6 m long and 0.75 m deep, open towards the carriageway.
Mesh MakeBusShelter(const Materials& materials, Random random);

}  // namespace orb360::town
