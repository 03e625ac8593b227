#pragma once

#include <span>

#include "apps/town/render/shading_kernels.h"
#include "apps/town/render/sky.h"
#include "apps/town/render/surface_lanes.h"
#include "apps/town/render/surroundings.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Upper limit that keeps one bright sample from dominating a pixel.
inline constexpr float kMaximumRadiance = 5.0F;

/// Computes the light from hits.
class Shader {
 public:
  Shader(const Palette& palette, const Light& light, const Sky& sky);

  const Light& light() const { return *light_; }
  const Sky& sky() const { return *sky_; }
  /// Sets the factor on all radiance, 1 at first.
  void set_exposure(float exposure) { exposure_ = exposure; }

  /// Returns the light from where the rays of a packet end, as the mean of `samples` (1 to
  /// kMaximumSamples). The first ones are the rays themselves; the others lie on the plane through
  /// the triangle that a ray hits. One sample is `sample_angle` wide, in radians. `met` is working
  /// memory.
  void Shade(const FrameScene& scene, const EyePacket& rays, std::span<const SampleLanes> samples,
             float sample_angle, SurfaceLanes* met, SightLanes* sight) const;

 private:
  const Palette* palette_;
  const Light* light_;
  const Sky* sky_;
  Surroundings surroundings_;
  float exposure_ = 1;
};

}  // namespace orb360::town
