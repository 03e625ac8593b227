#pragma once

#include "apps/town/world/landscape/landscape_materials.h"
#include "apps/town/world/materials.h"

namespace orb360::town {

/// Materials for tests that need no images: 0 plain, 1 plain with tiles of 4 m, 2 a cut-out that
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

/// Plain materials under every name that the builders of houses and things use; those of a kind
/// that is told apart (`paint`, `leaves`) have a number of their own.
inline Materials NamedPlainMaterials() {
  Materials m = PlainMaterials();
  m.paint = 3;
  m.all.push_back({.finish = Finish::kPaint});
  for (auto* list : {&m.bricks, &m.rooms, &m.shops, &m.doors, &m.signs, &m.posters,
                     &m.house_numbers, &m.murals, &m.roller_shutters})
    list->push_back(0);
  m.leaves.push_back(2);
  return m;
}

/// As above, for landscapes and tunnels.
inline LandscapeMaterials PlainLandscapeMaterials() {
  LandscapeMaterials m{};
  static_cast<Materials&>(m) = NamedPlainMaterials();
  for (auto* list : {&m.needles, &m.ferns, &m.grass_tufts, &m.dry_tufts}) list->push_back(2);
  m.rocks = {0, 1};
  return m;
}

}  // namespace orb360::town
