#pragma once

#include <cstdint>

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// The ground a building stands on: a rectangle whose front faces the street.
struct Lot {
  Vector3f front_left;    ///< seen from the street; z is the pavement's height
  Vector3f right;         ///< unit, along the front
  float width = 0;        ///< metres along the front
  float depth = 0;        ///< metres away from the street
  float ground_drop = 0;  ///< how far the terrain falls below front_left.z under the lot
};

/// Adds one building in a style drawn from `random`.
void AddBuilding(const Lot& lot, Random& random, MeshBuilder& builder);

}  // namespace orb360::town
