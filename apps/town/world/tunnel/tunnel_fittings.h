#pragma once

#include <functional>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/lamp.h"
#include "apps/town/world/landscape/landscape_materials.h"
#include "apps/town/world/tunnel/lining.h"

namespace orb360::town {

/// A tunnel into which things are built, along its trail.
struct FittingKit {
  const Trail& trail;
  std::function<float(const Vector2f&)> floor;  ///< its height at a place of the plan, metres
  const LandscapeMaterials& m;
  MeshBuilder& b;
  std::vector<Lamp>& lamps;
  Random random;

  float Draw(double low, double high) { return static_cast<float>(random.Uniform(low, high)); }
};

/// A row of lamps: boxes that shine downward.
struct LampRow {
  float spacing = 6;          ///< metres
  float x = 0;                ///< to the right of the middle, metres
  float height = 2.4F;        ///< above the floor, metres
  Vector2f size{0.1F, 0.1F};  ///< along the tunnel and across it, metres
  float brightness = 0.3F;    ///< of a white floor below, as a radiance
  float lit_width = 3;        ///< of the tunnel, metres
  float broken = 0.1F;        ///< fraction of the lamps that are dark
};

void AddLampRow(const LampRow& row, FittingKit& kit);

/// Adds a cable or a pipe along a wall, between points of the trail in straight pieces.
void AddPipe(float x, float height, float radius, const Rgba& tint, FittingKit& kit);

/// Adds frames of two posts and a cap of timber, `spacing` metres apart.
void AddTimberSets(float spacing, float half_width, float height, FittingKit& kit);

/// Adds rails on sleepers.
void AddRails(float gauge, FittingKit& kit);

}  // namespace orb360::town
