#pragma once

#include <span>

#include "apps/town/render/shading_kernels.h"
#include "apps/town/render/sky.h"
#include "apps/town/render/surface_lanes.h"
#include "apps/town/render/surroundings.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Keeps one bright sample from outshining a pixel.
inline constexpr float kMaximumRadiance = 5.0F;

/// Turns hits into light.
class Shader {
 public:
  Shader(const Palette& palette, const Light& light, const Sky& sky);

  const Light& light() const { return *light_; }
  const Sky& sky() const { return *sky_; }

  /// Light from where the rays of a packet end, as the mean of `samples` (1 to kMaximumSamples):
  /// the first are the rays themselves, the others lie on the plane through the triangle that a ray
  /// meets. One sample is `sample_angle` wide, in radians. `met` is room to work in.
  void Shade(const FrameScene& scene, const EyePacket& rays, std::span<const SampleLanes> samples,
             float sample_angle, SurfaceLanes* met, SightLanes* sight) const;

 private:
  const Palette* palette_;
  const Light* light_;
  const Sky* sky_;
  Surroundings surroundings_;
};

}  // namespace orb360::town
