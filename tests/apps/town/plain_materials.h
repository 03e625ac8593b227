#pragma once

#include "apps/town/world/materials.h"

namespace orb360::town {

/// Materials for tests that need no pictures: 0 plain, 1 plain with tiles of 4 m, 2 a cut-out that
/// is there only where u < 0.5 (in each tile).
inline Materials PlainMaterials() {
  Materials materials{};
  materials.textures.push_back(Texture::Paint(16, [](float, float) {
    return Rgba{0.5F, 0.5F, 0.5F, 1};
  }));
  materials.textures.push_back(Texture::Paint(16, [](float x, float) {
    return Rgba{0.5F, 0.5F, 0.5F, x < 0.5F ? 1.0F : 0.0F};
  }));
  materials.all.push_back({});
  materials.all.push_back({.tiles_per_metre = 0.25F});
  materials.all.push_back({.texture = 1, .cutout = true});
  return materials;
}

}  // namespace orb360::town
