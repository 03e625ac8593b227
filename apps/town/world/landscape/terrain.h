#pragma once

#include <cstdint>

#include "apps/town/world/landscape/trail.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

struct TerrainOptions {
  uint32_t seed = 0;
  float hills = 2;       ///< standard deviation of the height, metres, ...
  float hill_size = 40;  ///< ... over places so far apart, metres
  float bumps = 0.1F;    ///< of what is smaller than 3 m, beside the trail, metres
  float mountains = 20;  ///< height of what is far away, metres
};

/// Materials of the ground. All have textures of the same size.
struct GroundMaterials {
  MaterialId trail;
  MaterialId open;   ///< beside it
  MaterialId steep;  ///< where it is steeper than soil is
  MaterialId other;  ///< in patches, in place of `open`
};

/// Hills as heights over a plane, smooth along a trail. Keeps a reference to the trail.
class Terrain {
 public:
  Terrain(const Trail& trail, const TerrainOptions& options) : trail_(&trail), options_(options) {}

  /// Returns the height at a place, metres.
  float Height(const Vector2f& p) const;
  /// Adds the ground: fine meshes within `reach` metres of the origin, coarse ones to the horizon.
  void AddGround(float reach, const GroundMaterials& materials, MeshBuilder& b) const;

 private:
  float Height(const Vector2f& p, float from_trail) const;
  /// Adds the cells of a square grid whose middle `holds`; its vertices within `sunk_within` metres
  /// lie lower.
  template <typename Holds>
  void AddGrid(float half, float cell, float sunk_within, const GroundMaterials& materials,
               MeshBuilder& b, Holds holds) const;

  const Trail* trail_;
  TerrainOptions options_;
};

}  // namespace orb360::town
