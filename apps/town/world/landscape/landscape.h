#pragma once

#include <cstdint>

#include "apps/town/world/landscape/landscape_materials.h"
#include "apps/town/world/landscape/terrain.h"
#include "apps/town/world/landscape/trail.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

enum class LandscapeKind { kBroadleavedWood, kConiferWood, kHeath, kRockyHills };
inline constexpr int kLandscapeKinds = 4;

/// Hills with what grows and lies on them, and a trail round through it.
struct Landscape {
  Trail trail;
  TerrainOptions terrain;
  Scenery scenery;

  /// Returns the height of the ground at a place, metres.
  float Height(const Vector2f& p) const { return Terrain(trail, terrain).Height(p); }
};

/// Returns the kind of landscape of a seed.
LandscapeKind KindOfLandscape(uint64_t seed);

inline constexpr float kFreeWidth = 0.8F;   ///< metres on either side of the trail's middle ...
inline constexpr float kFreeHeight = 2.6F;  ///< ... where nothing is so high above the ground

/// Builds the landscape of a seed.
Landscape BuildLandscape(uint64_t seed);
/// As above, of a given kind, from given materials.
Landscape BuildLandscape(uint64_t seed, LandscapeKind kind, LandscapeMaterials materials);

}  // namespace orb360::town
