#pragma once

#include "apps/town/render/ray_packet.h"
#include "apps/town/render/ray_scene.h"

namespace orb360::town {

/// What a ray from the eye meets.
struct Sighting {
  SurfaceHit hit = {nullptr, nullptr, nullptr};  ///< mesh: null for nothing
  float b = 0;  ///< barycentric weights of the triangle's second and third corner
  float c = 0;
  float range = 0;  ///< metres
  Vector3f direction;
  Vector3f normal;  ///< geometric, unit

  bool IsSky() const { return hit.mesh == nullptr; }
  Vector3f Way() const { return range * direction; }  ///< from the eye to the surface
};

Sighting See(const FrameScene& scene, const EyePacket& packet, int lane);

/// Whether two rays meet parts of one mesh that have one material and normals within 8 degrees.
bool SharePlane(const Sighting& a, const Sighting& b);

/// Whether one plane, or the sky, fills the way between what the rays of neighbouring pixels meet.
bool Join(const Sighting& a, const Sighting& b, float pixel_angle);

/// A way from the eye to the surface, ended a little before it, where a ray to the sun can start.
Vector3f LiftedWay(const Sighting& seen, const Vector3f& way);

}  // namespace orb360::town
