#pragma once

#include <array>
#include <cstdint>

#include "apps/town/image/lanes.h"
#include "apps/town/render/ray_packet.h"
#include "apps/town/render/ray_scene.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

inline constexpr float kBlotchMetres = 31.0F;  ///< across which the large-scale variation repeats

/// The surfaces that the rays of a packet hit, gathered from meshes and materials. Lanes without a
/// hit repeat one with a hit, so that computations are valid in all lanes.
struct SurfaceLanes {
  Lanes b;                  ///< barycentric weights of the second corner
  Lanes c;                  ///< and of the third
  Lanes range;              ///< metres
  Lanes3 geometric_normal;  ///< of any length, in the world

  alignas(64) std::array<std::array<Vertex, kLanes>, 3> vertices;                 ///< by corner
  alignas(64) std::array<std::array<std::array<float, 4>, kLanes>, 3> positions;  ///< likewise
  /// Rotation from the frame of vertices and positions to the world, by row and column; valid only
  /// if `any_turned`.
  std::array<Lanes, 9> rotation;

  Lanes texels_per_metre;  ///< of level 0, the geometric mean of both directions
  Lanes3 paint;            ///< factor on the colour
  Lanes openness;          ///< factor on the vertices'
  Lanes3 irradiance;       ///< in place of the sky's light; valid only if `any_baked`
  Lanes is_baked;          ///< 1 where the light is `irradiance`, else 0
  Lanes blotches;          ///< strength of the large-scale variation
  Lanes blotch_scale;      ///< its tiles for each of the texture's
  alignas(64) std::array<int32_t, kLanes> finish;
  std::array<const Texture*, kLanes> texture;

  std::array<uint32_t, kLanes> surface;  ///< object and material; 0 where nothing is met
  std::array<bool, kLanes> hits;
  bool any_turned;
  bool any_blotches;
  bool any_baked;
  bool any_mirror;
};

/// Returns whether any ray hit a surface; otherwise `met` is not changed.
bool Gather(const FrameScene& scene, const Palette& palette, const EyePacket& rays,
            SurfaceLanes* met);

}  // namespace orb360::town
