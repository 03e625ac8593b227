#include "apps/town/world/interior/interior_materials.h"

#include <array>
#include <span>
#include <utility>

#include "apps/town/image/paint_rooms.h"

namespace orb360::town {
namespace {

/// Returns a colour near grey, as the paints, carpets and papers of most rooms are.
Rgba DrawTone(Random& random, double low, double high) {
  const double value = random.Uniform(low, high);
  const double warm = random.Uniform(-0.15, 0.3);
  const double green = random.Uniform(-0.08, 0.08);
  return {static_cast<float>(value * (1 + warm)), static_cast<float>(value * (1 + green)),
          static_cast<float>(value * (1 - warm)), 1};
}

constexpr std::array<Rgba, 6> kWoods = {{{0.42F, 0.27F, 0.15F, 1},
                                         {0.55F, 0.39F, 0.23F, 1},
                                         {0.25F, 0.14F, 0.08F, 1},
                                         {0.36F, 0.2F, 0.1F, 1},
                                         {0.5F, 0.43F, 0.33F, 1},
                                         {0.16F, 0.1F, 0.07F, 1}}};

}  // namespace

InteriorMaterials PaintInteriorMaterials(const Random& random) {
  InteriorMaterials m;
  static_cast<Materials&>(m) = PaintMaterials(random.Fork(1).Next());
  Random draw = random.Fork(2);
  const auto seed = [&] { return static_cast<uint32_t>(draw.Next()); };
  const auto add = [&](Texture texture, float tile_metres, float blotches) {
    m.textures.push_back(std::move(texture));
    m.all.push_back({static_cast<uint16_t>(m.textures.size() - 1), Finish::kMatte, false,
                     1 / tile_metres, blotches});
    return static_cast<MaterialId>(m.all.size() - 1);
  };
  const auto wood = [&] {
    const auto shade = static_cast<float>(draw.Uniform(0.8, 1.2));
    return shade * draw.Pick(std::span<const Rgba>(kWoods));
  };
  m.wall_paint = add(PaintWallPaint(seed(), static_cast<float>(draw.Uniform(0, 0.35))), 3, 0.12F);
  m.worn_paint = add(PaintWallPaint(seed(), static_cast<float>(draw.Uniform(0.6, 1))), 3, 0.3F);
  m.ceiling_panels = add(PaintCeilingPanels(seed()), 2.4F, 0.1F);
  m.screed = add(PaintScreed(seed()), 6, 0.4F);
  m.veneer = add(PaintVeneer(seed()), 1, 0.1F);
  m.plain = m.trim;
  for (int i = 0; i < 3; ++i) {
    const Rgba ground = DrawTone(draw, 0.3, 0.65);
    const Rgba figure =
        Mix(ground, DrawTone(draw, 0.1, 0.7), static_cast<float>(draw.Uniform(0.3, 1)));
    m.wallpapers.push_back(add(PaintWallpaper(seed(), ground, figure), 1.5F, 0.12F));
  }
  for (const int rows : {8 + 2 * draw.Int(4), 20 + 4 * draw.Int(4)})
    m.planks.push_back(add(PaintPlanks(seed(), rows, wood()), 2, 0.12F));
  m.planks.push_back(add(PaintHerringbone(seed(), wood()), 1.6F, 0.12F));
  for (int i = 0; i < 2; ++i) {
    const int columns = 3 + draw.Int(6);
    const Rgba tile = DrawTone(draw, 0.12, 0.6);
    m.floor_tiles.push_back(
        add(PaintTiles(seed(), columns, columns, tile, DrawTone(draw, 0.05, 0.6), draw.Chance(0.3)),
            2, 0.15F));
  }
  for (int i = 0; i < 2; ++i) {
    const int columns = 6 + draw.Int(8);
    const Rgba tile = draw.Chance(0.6) ? DrawTone(draw, 0.55, 0.75) : DrawTone(draw, 0.1, 0.6);
    m.wall_tiles.push_back(add(PaintTiles(seed(), columns, columns * (1 + draw.Int(2)), tile,
                                          DrawTone(draw, 0.2, 0.7), false),
                               2, 0.08F));
  }
  for (int i = 0; i < 2; ++i)
    m.terrazzos.push_back(add(PaintTerrazzo(seed(), DrawTone(draw, 0.15, 0.5)), 2, 0.2F));
  for (int i = 0; i < 2; ++i)
    m.carpets.push_back(add(PaintCarpet(seed(), DrawTone(draw, 0.04, 0.3)), 2, 0.25F));
  for (int i = 0; i < 8; ++i) {
    const Rgba ground = DrawTone(draw, 0.03, 0.6);
    m.cloths.push_back(
        add(PaintCloth(seed(), ground, Mix(ground, DrawTone(draw, 0.05, 0.7), 0.7F)), 0.8F, 0.1F));
  }
  for (int i = 0; i < 10; ++i) m.books.push_back(add(PaintBooks(seed()), 1, 0));
  for (int i = 0; i < 8; ++i) m.cartons.push_back(add(PaintCarton(seed()), 1, 0.1F));
  for (int i = 0; i < 10; ++i) m.pictures.push_back(add(PaintPicture(seed()), 1, 0));
  for (int i = 0; i < 4; ++i) m.screens.push_back(add(PaintScreen(seed()), 1, 0));
  return m;
}

}  // namespace orb360::town
