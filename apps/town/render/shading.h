#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "apps/town/image/lanes.h"
#include "apps/town/render/sky.h"
#include "apps/town/render/surface_lanes.h"
#include "apps/town/render/surroundings.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

inline constexpr float kMaximumRadiance =
    5.0F;  ///< keeps one bright sample from outshining a pixel

/// A sample of a pixel in each lane.
struct SampleLanes {
  Lanes3 direction;  ///< unit
  /// In [0, 1): spread evenly over a pixel's samples, they blend two mip levels.
  Lanes level_offset;
};

/// What the rays of a packet see.
struct SightLanes {
  std::array<uint32_t, kLanes> surface;  ///< object and material; 0 for the sky
  Lanes range;                           ///< metres; this and the following not for the sky
  Lanes3 way;                            ///< from the eye to the surface
  Lanes3 geometric_normal;               ///< unit
  Lanes sun_cosine;                      ///< how squarely the sun shines on it; 0 if from behind
  Lanes3 shade;                          ///< radiance where the sun is hidden
  Lanes3 sun;                            ///< radiance that the sun adds; 0 for the sky
};

/// Turns hits into light.
class Shader {
 public:
  Shader(const Palette& palette, const Light& light, const Sky& sky);

  const Light& light() const { return *light_; }
  const Sky& sky() const { return *sky_; }

  /// Light from where the rays of a packet end, as the mean of `samples` (1 to 4): the first are
  /// the rays themselves, the others lie on the plane through the triangle that a ray meets. One
  /// sample is `sample_angle` wide, in radians. `met` is room to work in.
  void Shade(const FrameScene& scene, const EyePacket& rays, std::span<const SampleLanes> samples,
             float sample_angle, SurfaceLanes* met, SightLanes* sight) const;

 private:
  const Palette* palette_;
  const Light* light_;
  const Sky* sky_;
  Surroundings surroundings_;
};

}  // namespace orb360::town
