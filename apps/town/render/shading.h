#pragma once

#include "apps/town/render/ray_scene.h"
#include "apps/town/render/sky.h"
#include "apps/town/render/surroundings.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// A piece of surface that fills (a part of) a pixel, with what is the same all over it.
struct Surface {
  Vector3f tone;  ///< factor on the texture: tint and blotches
  const Texture* texture;
  float level;       ///< mip level for one sample
  Vector3f normal;   ///< unit, on the side of the ray's origin
  float openness;    ///< share of the sky that is seen
  float sun_cosine;  ///< how squarely the sun shines on it; 0 if from behind
  Finish finish;
};

/// A hit's place in its texture, in tiles.
Vector2f TextureCoordinates(const SurfaceHit& hit, float b, float c);

/// The places in a texture of the points around a hit that lie in its triangle's plane.
struct TextureMapping {
  Vector2f here;                      ///< tiles
  Eigen::Matrix<float, 2, 3> by_way;  ///< tiles per metre

  Vector2f At(const Vector3f& way) const { return here + by_way * way; }
};
TextureMapping MapTexture(const SurfaceHit& hit, float b, float c);

/// Turns hits into light.
class Shader {
 public:
  Shader(const Palette& palette, const Light& light, const Sky& sky);

  const Light& light() const { return *light_; }
  const Sky& sky() const { return *sky_; }

  /// `b` and `c` are the barycentric weights of the triangle's second and third corner, `footprint`
  /// the width in metres, across the ray, of the area that one sample stands for.
  Surface Describe(const SurfaceHit& hit, float b, float c, const Vector3f& direction,
                   float footprint) const;

  /// The texture's colour at a place on a surface. Offsets in [0, 1) that are spread evenly over a
  /// pixel's samples blend two mip levels.
  static Vector3f Colour(const Surface& surface, const Vector2f& uv, float level_offset);

  /// Light that leaves the surface against `direction`, `range` metres from the eye; `albedo` is
  /// the mean colour of its texture, `sunlit` the share of it that the sun reaches.
  Vector3f Radiance(const Surface& surface, const Vector3f& albedo, float sunlit,
                    const Vector3f& direction, float range) const;

 private:
  const Palette* palette_;
  const Light* light_;
  const Sky* sky_;
  Surroundings surroundings_;
};

}  // namespace orb360::town
