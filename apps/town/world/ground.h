#pragma once

#include "apps/town/world/mesh.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// Height of the pavement above the carriageway, metres.
inline constexpr double kKerbHeight = 0.12;

/// Adds carriageways, kerbs, pavements and the land behind them, within reach of the streets.
void AddGround(const StreetPlan& plan, MeshBuilder& builder);

/// Adds lane lines, edge lines, stop lines and zebra crossings, a few millimetres above the
/// asphalt.
void AddRoadMarkings(const StreetPlan& plan, MeshBuilder& builder);

}  // namespace orb360::town
