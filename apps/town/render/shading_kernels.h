#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "apps/town/image/lanes.h"
#include "apps/town/render/sky.h"
#include "apps/town/render/surface_lanes.h"

namespace orb360::town {

inline constexpr size_t kMaximumSamples = 4;  ///< of a pixel

/// One sample of a pixel per lane.
struct SampleLanes {
  Lanes3 direction;  ///< unit
  /// In [0, 1). Distributed evenly over a pixel's samples, the offsets blend two mip levels.
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

/// Surfaces with the properties that are constant over a pixel, and the positions of the pixel's
/// samples on them.
struct DescribedLanes {
  struct Place {
    Lanes u;
    Lanes v;
    Lanes level;
  };
  std::array<Place, kMaximumSamples> samples;
  Place blotch;
  Lanes3 tone;    ///< factor on the texture: tint and paint
  Lanes3 normal;  ///< unit, on the side of the eye
  Lanes openness;
  Lanes cosine;     ///< of the angle between the normal and the way to the eye
  Lanes3 mirrored;  ///< where a mirror would show
};

/// Describes the surfaces that are hit: fills `described`, and all of `sight` except the light. The
/// first samples are the rays themselves; the others lie on the planes of the triangles that the
/// rays hit. One sample is `sample_angle` wide, in radians. `blotch_side` is the side of the
/// texture of the blotches, in texels.
void Describe(const SurfaceLanes& met, std::span<const SampleLanes> samples, float sample_angle,
              const Light& light, float blotch_side, DescribedLanes* described, SightLanes* sight);

/// Computes the light of `sight`. `albedo` and `blotches` are colours of textures; `reflected` is
/// the radiance that mirrors show.
void Illuminate(const SurfaceLanes& met, const DescribedLanes& described, const Lanes3& albedo,
                const Lanes3& blotches, const Lanes3& reflected, const Light& light,
                const Vector3f& sky_mean, SightLanes* sight);

}  // namespace orb360::town
