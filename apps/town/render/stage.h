#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/render/ray_scene.h"
#include "apps/town/render/shading.h"
#include "apps/town/render/sky.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// A scenery under a sky, ready to be rendered.
class Stage {
 public:
  /// Keeps a pointer to the scenery and computes the light of its lamps and its openness, which
  /// takes seconds. The clouds are
  /// drawn from the seed.
  Stage(Scenery* scenery, const Light& light, uint64_t seed);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Sets the factor on the radiance of all images, 1 at first.
  void set_exposure(float exposure) { shader_.set_exposure(exposure); }
  const RayScene& scene() const { return scene_; }
  const Shader& shader() const { return shader_; }
  FrameScene With(std::vector<Instance> moving) const { return {scene_, std::move(moving)}; }

 private:
  Light light_;
  Sky sky_;
  RayScene scene_;
  Shader shader_;
};

}  // namespace orb360::town
