#include "apps/town/render/sighting.h"

#include <cmath>

namespace orb360::town {

Sighting See(const FrameScene& scene, const EyePacket& packet, int lane) {
  Sighting seen;
  seen.direction = packet.Direction(lane);
  if (!packet.Hits(lane)) return seen;
  seen.hit = scene.Resolve(packet.hit(), lane);
  seen.b = packet.hit().u[lane];
  seen.c = packet.hit().v[lane];
  seen.range = packet.range(lane);
  seen.normal = scene.GeometricNormal(packet.hit(), lane);
  seen.normal *= 1 / seen.normal.norm();
  return seen;
}

bool SharePlane(const Sighting& a, const Sighting& b) {
  constexpr float kCosine = 0.99F;  // of 8 degrees
  return a.hit.mesh == b.hit.mesh && a.hit.instance == b.hit.instance &&
         a.hit.triangle->material == b.hit.triangle->material && a.normal.dot(b.normal) > kCosine;
}

bool Join(const Sighting& a, const Sighting& b, float pixel_angle) {
  if (a.IsSky() || b.IsSky()) return a.IsSky() && b.IsSky();
  if (!SharePlane(a, b)) return false;
  // A step of a quarter of a pixel, or 5 mm, is the curvature that SharePlane allows.
  const float off_plane = std::abs(a.normal.dot(b.Way() - a.Way()));
  return off_plane < 5e-3F + 0.25F * pixel_angle * a.range;
}

Vector3f LiftedWay(const Sighting& seen, const Vector3f& way) {
  // Metres; well above the rounding of coordinates.
  const float lift = 2e-3F + 1e-5F * seen.range;
  const float side = seen.normal.dot(seen.direction) > 0 ? -lift : lift;
  return way + side * seen.normal;
}

}  // namespace orb360::town
