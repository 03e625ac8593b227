#pragma once

#include "apps/town/render/ray_scene.h"
#include "apps/town/render/sky.h"
#include "apps/town/world/town.h"

namespace orb360::town {

/// The point where a ray met a surface, with what lighting needs.
struct Surface {
  Vector3f albedo;
  Vector3f normal;   ///< unit, on the side of the ray's origin
  float openness;    ///< share of the sky that is seen
  float sun_cosine;  ///< how squarely the sun shines on it; 0 if from behind
  Finish finish;
};

/// Turns hits into light.
class Shader {
 public:
  Shader(const Town& town, const Light& light, const Sky& sky);

  const Light& light() const { return *light_; }
  const Sky& sky() const { return *sky_; }

  /// `b` and `c` are the barycentric weights of the triangle's second and third corner, `footprint`
  /// the width in metres of the area a sample stands for (across the ray), `level_offset` in
  /// [0, 1) spreads samples over two mip levels.
  Surface Evaluate(const SurfaceHit& hit, float b, float c, const Vector3f& direction,
                   float footprint, float level_offset) const;

  /// Light that leaves the surface against `direction`, `range` metres from the eye.
  Vector3f Radiance(const Surface& surface, bool sunlit, const Vector3f& direction,
                    float range) const;

 private:
  const Town* town_;
  const Light* light_;
  const Sky* sky_;
};

}  // namespace orb360::town
