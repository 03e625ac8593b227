#pragma once

#include <array>
#include <span>

#include "apps/town/render/ray_directions.h"
#include "apps/town/render/ray_scene.h"

namespace orb360::town {

inline constexpr float kFar = 3000.0F;  ///< metres; rays end there

/// One of a pixel's samples.
struct SamplePlace {
  int column = 0;
  int row = 0;
  size_t sample = 0;
};

/// Rays from one eye, at most kPacket, and what they meet.
class EyePacket {
 public:
  /// Traces the rays through `places`.
  void Trace(const FrameScene& scene, const RayDirections& directions, const Vector3f& eye,
             std::span<const SamplePlace> places);

  bool Hits(int lane) const { return rays_.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }
  const RTCHit16& hit() const { return rays_.hit; }
  float range(int lane) const { return rays_.ray.tfar[lane]; }  ///< metres
  Vector3f Direction(int lane) const {
    return {rays_.ray.dir_x[lane], rays_.ray.dir_y[lane], rays_.ray.dir_z[lane]};
  }

 private:
  RTCRayHit16 rays_;
  alignas(64) std::array<int, kPacket> valid_;
};

/// Rays towards a light, at most kPacket.
class ShadowPacket {
 public:
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
  /// Whether a ray was set in a lane and met nothing.
  bool IsLit(int lane) const {
    return valid_[static_cast<size_t>(lane)] != 0 && rays_.tfar[lane] >= 0;
  }

 private:
  RTCRay16 rays_;
  alignas(64) std::array<int, kPacket> valid_;
  bool any_ = false;
};

}  // namespace orb360::town
