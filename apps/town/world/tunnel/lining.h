#pragma once

#include <vector>

#include "apps/town/world/landscape/trail.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A strip of a tunnel's cross-section, from one place to another. Seen along the tunnel, x is to
/// the right of its middle and y is up, metres; the hollow is on the left of the strip.
struct ProfileStrip {
  MaterialId material = 0;
  Vector2f from, to;
  Rgba tint = {1, 1, 1, 1};
};

/// Returns the outline of an arched tunnel from the foot of its right wall over its crown to the
/// foot of its left one: walls up to `springing`, and an arch in `parts` strips up to `crown`.
std::vector<ProfileStrip> ArchedProfile(MaterialId wall, MaterialId arch, float half_width,
                                        float springing, float crown, int parts);

/// Adds a cross-section all along a closed trail, level at z = 0. Textures are in metres along the
/// trail and along the profile.
void AddLining(const Trail& trail, const std::vector<ProfileStrip>& profile, MeshBuilder& b);

/// A place on a trail, and the directions along it and to its right.
struct TrailFrame {
  Vector3f origin, along, right;

  Vector3f At(float x, float y, float forward = 0) const {
    return origin + x * right + y * Vector3f::UnitZ() + forward * along;
  }
};
TrailFrame FrameAt(const Trail& trail, size_t point);

}  // namespace orb360::town
