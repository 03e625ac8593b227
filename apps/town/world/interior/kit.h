#pragma once

#include <span>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/interior/interior_materials.h"
#include "apps/town/world/interior/room_shell.h"

namespace orb360::town {

/// What furniture is made from in one room.
struct Kit {
  MeshBuilder& b;
  const InteriorMaterials& m;
  Random& random;
  Coat wood;    ///< of tables and cupboards
  Coat second;  ///< of doors and seats: another wood, or lacquer
  Coat cloth;
  Coat metal;

  float Draw(double low, double high) { return static_cast<float>(random.Uniform(low, high)); }
  MaterialId Pick(const std::vector<MaterialId>& list) {
    return random.Pick(std::span<const MaterialId>(list));
  }
  MaterialId Use(const Coat& coat) {
    b.set_tint(coat.tint);
    return coat.material;
  }
  MaterialId UseGrey(float value) {
    b.set_tint({value, value, value, 1});
    return m.plain;
  }
  /// Sets a lively colour for small goods.
  MaterialId UseColour();
};

/// Draws what the furniture of a room is made from.
Kit MakeKit(MeshBuilder& b, const InteriorMaterials& m, Random& random);

/// Returns the panel of something that stands on another panel's ground, turned about the vertical
/// by `angle` (counter-clockwise from above), with its origin at (x, depth) and at height z.
Panel Turned(const Panel& p, float x, float depth, float angle, float z = 0);

/// Adds a box with all six sides.
void AddSolid(MeshBuilder& b, MaterialId material, const Panel& p, float x0, float x1, float z0,
              float z1, float depth0, float depth1);
/// Adds a box with rounded edges (a superellipsoid) and smooth normals, as of upholstery.
void AddCushion(MeshBuilder& b, MaterialId material, const Panel& p, float x0, float x1, float z0,
                float z1, float depth0, float depth1);
/// Adds a vertical cylinder with a lid.
void AddDrum(MeshBuilder& b, MaterialId material, const Vector3f& foot, float radius, float height,
             int sides = 14);
/// Adds four legs below a height.
void AddLegs(Kit& kit, const Coat& coat, const Panel& p, float x0, float x1, float depth0,
             float depth1, float height, float side);

}  // namespace orb360::town
