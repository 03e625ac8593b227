#include "apps/town/world/landscape/landscape_materials.h"

#include <utility>

#include "apps/town/image/paint_nature.h"

namespace orb360::town {

LandscapeMaterials PaintLandscapeMaterials(const Random& random) {
  LandscapeMaterials m;
  static_cast<Materials&>(m) = PaintMaterials(random.Fork(1).Next());
  Random draw = random.Fork(2);
  const auto seed = [&] { return static_cast<uint32_t>(draw.Next()); };
  const auto add = [&](Texture texture, const Material& material) {
    m.textures.push_back(std::move(texture));
    m.all.push_back(material);
    m.all.back().texture = static_cast<uint16_t>(m.textures.size() - 1);
    return static_cast<MaterialId>(m.all.size() - 1);
  };
  const Material ground{.tiles_per_metre = 0.25F, .blotches = 0.5F};
  m.leaf_litter = add(PaintForestFloor(seed(), 0.75F, 0.1F), ground);
  m.moss = add(PaintForestFloor(seed(), 0.25F, 0.75F), ground);
  m.needle_floor = add(PaintForestFloor(seed(), 0.08F, 0.3F), ground);
  m.heath = add(PaintHeath(seed()), ground);
  m.trail = add(PaintTrail(seed()), ground);
  for (int i = 0; i < 2; ++i) m.rocks.push_back(add(PaintRock(seed()), ground));
  const Material plant{.finish = Finish::kFoliage, .cutout = true};
  for (int i = 0; i < 3; ++i) m.needles.push_back(add(PaintNeedleBranch(seed()), plant));
  for (int i = 0; i < 2; ++i) m.ferns.push_back(add(PaintFern(seed()), plant));
  for (int i = 0; i < 2; ++i) m.grass_tufts.push_back(add(PaintGrassTuft(seed(), 0.15F), plant));
  for (int i = 0; i < 2; ++i) m.dry_tufts.push_back(add(PaintGrassTuft(seed(), 0.85F), plant));
  return m;
}

}  // namespace orb360::town
