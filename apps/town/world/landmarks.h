#pragma once

#include "apps/town/world/mesh.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

inline constexpr double kPathHalfWidth = 1.1;  ///< of a park's paths, metres
inline constexpr double kParkCircle = 3.6;     ///< radius of the paths' meeting place, metres

/// Adds paths of gravel from a park's gates to its centre, on the grass.
void AddParkPaths(const StreetPlan& plan, const Park& park, MeshBuilder& builder);

/// Adds a railway bridge: brick walls on either side of the street, girders, and a deck above it.
void AddBridge(const StreetPlan& plan, const Bridge& bridge, MeshBuilder& builder);

}  // namespace orb360::town
