#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/world/lamp.h"
#include "apps/town/world/materials.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A model placed in the world by a rotation and a translation.
struct Instance {
  uint32_t model = 0;
  Eigen::Isometry3f world_from_model = Eigen::Isometry3f::Identity();
  Rgba tint;           ///< linear factor on the surfaces with Finish::kPaint
  float lookout = 3;   ///< metres above its origin from which it sees its surroundings freely
  float openness = 1;  ///< fraction of the sky seen from there
};

/// The scenery that is rendered: everything that stands still, and the models of instances.
struct Scenery {
  Palette palette;
  Mesh fixed;                ///< ground and buildings
  std::vector<Mesh> models;  ///< trees, lamp posts, cars, ... shared by instances
  std::vector<Instance> instances;
  /// What lights `fixed` from within. If there are any, Stage bakes their light into its
  /// irradiance; instances are lit by the sky.
  std::vector<Lamp> lamps;
};

}  // namespace orb360::town
