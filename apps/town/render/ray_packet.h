#pragma once

#include <array>

#include "apps/town/image/lanes.h"
#include "apps/town/render/ray_scene.h"

namespace orb360::town {

inline constexpr float kFar = 3000.0F;  ///< metres; rays end there

/// Rays from one eye, and the surfaces that they meet.
class EyePacket {
 public:
  EyePacket();

  /// Traces rays in unit directions.
  void Trace(const FrameScene& scene, const Vector3f& eye, const Lanes3& directions);

  bool Hits(int lane) const { return rays_.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }
  const RTCHit16& hit() const { return rays_.hit; }
  float range(int lane) const { return rays_.ray.tfar[lane]; }  ///< metres

 private:
  RTCRayHit16 rays_;
};

/// Rays towards a light, at most kPacket.
class ShadowPacket {
 public:
  ShadowPacket() {
    for (int lane = 0; lane < kPacket; ++lane) Set(lane, Vector3f::Zero(), Vector3f::Zero());
    Clear();
  }
  void Clear() {
    valid_.fill(0);
    any_ = false;
  }
  void Set(int lane, const Vector3f& point, const Vector3f& direction) {
    SetRay(rays_, lane, point, direction, kFar);
    valid_[static_cast<size_t>(lane)] = -1;
    any_ = true;
  }
  void Trace(const FrameScene& scene) {
    if (any_) scene.Occluded(valid_.data(), &rays_);
  }
  /// Returns true if a ray was set in a lane and hit nothing.
  bool IsLit(int lane) const {
    return valid_[static_cast<size_t>(lane)] != 0 && rays_.tfar[lane] >= 0;
  }

 private:
  RTCRay16 rays_;
  alignas(64) std::array<int, kPacket> valid_;
  bool any_ = false;
};

}  // namespace orb360::town
