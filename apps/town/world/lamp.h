#pragma once

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A rectangle that emits light towards the side from which its sides turn counter-clockwise.
struct Lamp {
  Vector3f corner;
  Vector3f first_side;
  Vector3f second_side;
  Vector3f radiance = Vector3f::Zero();  ///< the same in all directions
  bool is_window = false;                ///< instead, the sky and the ground beyond shine through

  Vector3f Centre() const { return corner + 0.5F * (first_side + second_side); }
};

}  // namespace orb360::town
