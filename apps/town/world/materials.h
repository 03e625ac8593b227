#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/image/texture.h"

namespace orb360::town {

using MaterialId = uint16_t;

/// The reflection model of a surface.
enum class Finish : uint8_t {
  kMatte,
  kPaint,    ///< clear coat over the colour; takes the instance's tint
  kGlass,    ///< what lies behind, and the reflection of the surroundings
  kFoliage,  ///< lets light through
  kLamp,     ///< shines by itself
};

struct Material {
  uint16_t texture = 0;
  Finish finish = Finish::kMatte;
  bool cutout = false;        ///< absent where the texture's coverage is below one half
  float tiles_per_metre = 1;  ///< for faces textured in metres
  float blotches = 0;         ///< strength of the large-scale variation
};

/// Textures and the materials that use them.
struct Palette {
  std::vector<Texture> textures;
  std::vector<Material> all;
  uint16_t blotches_texture = 0;  ///< of the large-scale variation

  const Material& operator[](MaterialId id) const { return all[id]; }
};

/// The palette of a procedural town, with the names that the builders use.
struct Materials : Palette {
  MaterialId asphalt, fresh_asphalt, manhole, drain, setts, paving, kerb, grass, road_paint;
  MaterialId plaster, ashlar, concrete, roof_tiles, slates, gravel;
  MaterialId trim;   ///< painted wood or stone around openings, to be tinted
  MaterialId metal;  ///< dark painted metal
  MaterialId number_plate;
  MaterialId louvres;  ///< of a window's shutter, to be tinted
  MaterialId railing, bark, paint, car_glass, rubber, lamp;
  std::vector<MaterialId> bricks, rooms, shops, doors, signs, leaves;
  std::vector<MaterialId> posters, house_numbers, murals, roller_shutters;
};

/// Paints every texture. The same seed gives the same materials.
Materials PaintMaterials(uint64_t seed);

}  // namespace orb360::town
