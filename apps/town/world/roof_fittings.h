#pragma once

#include <array>
#include <vector>

#include "apps/town/world/facade.h"

namespace orb360::town {

/// Where a roof stands: x along the front, y away from the street, z above the eaves.
struct RoofFrame {
  Vector3f origin;
  Vector3f right;
  Vector3f back;
  float width;
  float depth;

  Vector3f At(float x, float y, float z) const {
    return origin + x * right + y * back + z * Vector3f::UnitZ();
  }
  /// A panel that faces the street, its origin at (x, y, z).
  Panel Front(float x, float y, float z) const {
    return {At(x, y, z), right, Vector3f::UnitZ(), -back};
  }
};

/// A cut through a roof from front to back: y against z, running up to the ridge and down.
using Profile = std::vector<std::array<float, 2>>;

/// The profile's height over `y`, 0 beyond its ends.
float HeightOver(const Profile& profile, float y);

/// A free-standing box with all its sides but the bottom.
void AddBlock(MeshBuilder& b, MaterialId material, const RoofFrame& f, float x0, float x1, float y0,
              float y1, float z0, float z1);

/// A chimney with pots, its top `top` above the eaves.
void AddChimney(MeshBuilder& b, const RoofFrame& f, float x, float y, float top, Random& random);

/// A television aerial on a mast whose foot is at (x, y, z).
void AddAerial(MeshBuilder& b, const RoofFrame& f, float x, float y, float z);

/// A dormer over the front slope at `x`; its window stands at `y` on the slope.
void AddDormer(MeshBuilder& b, const RoofFrame& f, const FacadeStyle& style, MaterialId tiles,
               const Rgba& tile_tint, const Profile& profile, float x, float y, float height,
               Random& random);

/// A flat window in the front slope around (x, y).
void AddSkylight(MeshBuilder& b, const RoofFrame& f, const Profile& profile, float x, float y,
                 Random& random);

}  // namespace orb360::town
