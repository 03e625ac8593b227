#pragma once

#include <cstdint>
#include <functional>

#include "apps/town/world/landscape/landscape_materials.h"
#include "apps/town/world/landscape/trail.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

enum class TunnelKind { kMine, kCave, kRoad, kCulvert };
inline constexpr int kTunnelKinds = 4;

/// A tunnel without an opening, lit by lamps, and a trail round through it.
struct Tunnel {
  Trail trail;
  Scenery scenery;
  std::function<float(const Vector2f&)> floor;  ///< its height at a place of the plan, metres
  double head_room = 2;  ///< metres above the floor below which the trail is free
};

/// Returns the kind of tunnel of a seed.
TunnelKind KindOfTunnel(uint64_t seed);

/// Builds the tunnel of a seed.
Tunnel BuildTunnel(uint64_t seed);
/// As above, of a given kind, from given materials.
Tunnel BuildTunnel(uint64_t seed, TunnelKind kind, LandscapeMaterials materials);

}  // namespace orb360::town
