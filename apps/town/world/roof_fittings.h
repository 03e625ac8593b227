#pragma once

#include <array>
#include <vector>

#include "apps/town/world/facade.h"

namespace orb360::town {

/// The frame of a roof: x along the front, y away from the street, z above the eaves.
struct RoofFrame {
  Vector3f origin;
  Vector3f right;
  Vector3f back;
  float width;
  float depth;

  Vector3f At(float x, float y, float z) const {
    return origin + x * right + y * back + z * Vector3f::UnitZ();
  }
  /// Returns a panel that faces the street, with its origin at (x, y, z).
  Panel Front(float x, float y, float z) const {
    return {At(x, y, z), right, Vector3f::UnitZ(), -back};
  }
};

/// A section through a roof from front to back: y against z, up to the ridge and down.
using Profile = std::vector<std::array<float, 2>>;

/// Returns the profile's height over `y`, 0 beyond its ends.
float HeightOver(const Profile& profile, float y);

/// Adds a free-standing box with all its sides except the bottom.
void AddBlock(MeshBuilder& b, MaterialId material, const RoofFrame& f, float x0, float x1, float y0,
              float y1, float z0, float z1);

/// Adds a chimney with pots, whose top is `top` above the eaves.
void AddChimney(MeshBuilder& b, const RoofFrame& f, float x, float y, float top, Random& random);

/// Adds a television aerial on a mast whose foot is at (x, y, z).
void AddAerial(MeshBuilder& b, const RoofFrame& f, float x, float y, float z);

/// Adds a dormer over the front slope at `x`; its window is at `y` on the slope.
void AddDormer(MeshBuilder& b, const RoofFrame& f, const FacadeStyle& style, MaterialId tiles,
               const Rgba& tile_tint, const Profile& profile, float x, float y, float height,
               Random& random);

/// Adds a flat window in the front slope around (x, y).
void AddSkylight(MeshBuilder& b, const RoofFrame& f, const Profile& profile, float x, float y,
                 Random& random);

}  // namespace orb360::town
