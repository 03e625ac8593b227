#include "apps/town/render/ray_packet.h"

namespace orb360::town {

void EyePacket::Trace(const FrameScene& scene, const RayDirections& directions, const Vector3f& eye,
                      std::span<const SamplePlace> places) {
  valid_.fill(0);
  for (size_t i = 0; i < places.size(); ++i) {
    const SamplePlace& place = places[i];
    const int lane = static_cast<int>(i);
    SetRay(rays_.ray, lane, eye, directions.At(place.column, place.row, place.sample), kFar);
    rays_.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    rays_.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    valid_[i] = -1;
  }
  scene.Intersect(valid_.data(), &rays_);
}

}  // namespace orb360::town
