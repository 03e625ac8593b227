#include "apps/town/render/ray_packet.h"

#include <algorithm>

namespace orb360::town {

static_assert(kPacket == kLanes);

EyePacket::EyePacket() {
  for (int lane = 0; lane < kPacket; ++lane)
    SetRay(rays_.ray, lane, Vector3f::Zero(), Vector3f::Zero(), kFar);
}

void EyePacket::Trace(const FrameScene& scene, const Vector3f& eye, const Lanes3& directions) {
  alignas(64) static constexpr std::array<int, kPacket> kAll = {-1, -1, -1, -1, -1, -1, -1, -1,
                                                                -1, -1, -1, -1, -1, -1, -1, -1};
  std::fill_n(rays_.ray.org_x, kPacket, eye.x());
  std::fill_n(rays_.ray.org_y, kPacket, eye.y());
  std::fill_n(rays_.ray.org_z, kPacket, eye.z());
  std::copy_n(directions.x.begin(), kPacket, rays_.ray.dir_x);
  std::copy_n(directions.y.begin(), kPacket, rays_.ray.dir_y);
  std::copy_n(directions.z.begin(), kPacket, rays_.ray.dir_z);
  std::fill_n(rays_.ray.tfar, kPacket, kFar);
  std::fill_n(rays_.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(rays_.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
  scene.Intersect(kAll.data(), &rays_);
}

}  // namespace orb360::town
