#include "apps/town/world/materials.h"

#include <utility>

#include "apps/town/image/paint.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

class Library {
 public:
  Library(Materials& materials, uint64_t seed) : materials_(&materials), random_(seed) {}

  uint32_t NextSeed() { return static_cast<uint32_t>(random_.Next()); }
  uint16_t AddTexture(Texture texture) {
    materials_->textures.push_back(std::move(texture));
    return static_cast<uint16_t>(materials_->textures.size() - 1);
  }
  MaterialId Add(const Material& material) {
    materials_->all.push_back(material);
    return static_cast<MaterialId>(materials_->all.size() - 1);
  }
  /// Adds a matte material with a texture `tile_metres` wide.
  MaterialId AddMatte(Texture texture, float tile_metres, float blotches) {
    return Add({AddTexture(std::move(texture)), Finish::kMatte, false, 1 / tile_metres, blotches});
  }

 private:
  Materials* materials_;
  Random random_;
};

}  // namespace

Materials PaintMaterials(uint64_t seed) {
  Materials m;
  Library library(m, seed);
  const auto next = [&library] { return library.NextSeed(); };
  m.blotches_texture = library.AddTexture(PaintBlotches(next()));

  m.asphalt = library.AddMatte(PaintAsphalt(next()), 8, 0.5F);
  m.fresh_asphalt = library.AddMatte(PaintFreshAsphalt(next()), 4, 0.4F);
  m.manhole = library.Add({library.AddTexture(PaintManhole(next())), Finish::kMatte, false, 1, 0});
  m.drain = library.Add({library.AddTexture(PaintDrain(next())), Finish::kMatte, false, 1, 0});
  m.setts = library.AddMatte(PaintSetts(next()), 4, 0.4F);
  m.paving = library.AddMatte(PaintPavingSlabs(next()), 4, 0.4F);
  m.kerb = library.AddMatte(PaintConcrete(next()), 4, 0.4F);
  m.grass = library.AddMatte(PaintGrass(next()), 4, 0.5F);
  m.road_paint =
      library.Add({library.AddTexture(PaintRoadPaint(next())), Finish::kMatte, true, 0.25F, 0.3F});

  m.plaster = library.AddMatte(PaintPlaster(next()), 4, 0.35F);
  m.ashlar = library.AddMatte(PaintAshlar(next()), 4, 0.4F);
  m.concrete = library.AddMatte(PaintConcrete(next()), 4, 0.4F);
  m.roof_tiles = library.AddMatte(PaintRoofTiles(next()), 4, 0.4F);
  m.slates = library.AddMatte(PaintSlates(next()), 4, 0.4F);
  m.gravel = library.AddMatte(PaintGravel(next()), 4, 0.4F);
  const Rgba mortar = Srgb(172, 164, 150);
  for (const Rgba& brick :
       {Srgb(150, 78, 58), Srgb(186, 150, 108), Srgb(112, 62, 56), Srgb(176, 112, 82)}) {
    m.bricks.push_back(library.AddMatte(PaintBrick(next(), brick, mortar), 4, 0.4F));
  }

  const uint16_t plain = library.AddTexture(PaintPlain(next()));
  m.trim = library.Add({plain, Finish::kMatte, false, 1, 0.2F});
  m.metal = library.Add({plain, Finish::kMatte, false, 1, 0.1F});
  m.rubber = library.Add({plain, Finish::kMatte, false, 1, 0});
  m.paint = library.Add({plain, Finish::kPaint, false, 0.5F, 0});
  m.car_glass = library.Add({plain, Finish::kGlass, false, 1, 0});
  m.lamp = library.Add({plain, Finish::kLamp, false, 1, 0});
  m.railing = library.Add({library.AddTexture(PaintRailing(next())), Finish::kMatte, true, 1, 0});
  m.louvres = library.Add({library.AddTexture(PaintLouvres(next())), Finish::kMatte, false, 1, 0});
  for (int i = 0; i < 4; ++i)
    m.roller_shutters.push_back(library.Add(
        {library.AddTexture(PaintRollerShutter(next())), Finish::kMatte, false, 1, 0.2F}));
  m.bark = library.AddMatte(PaintBark(next()), 1, 0.3F);
  for (int i = 0; i < 40; ++i)
    m.rooms.push_back(
        library.Add({library.AddTexture(PaintRoom(next())), Finish::kGlass, false, 1, 0}));
  for (int i = 0; i < 12; ++i)
    m.shops.push_back(
        library.Add({library.AddTexture(PaintShop(next())), Finish::kGlass, false, 1, 0}));
  for (int i = 0; i < 8; ++i)
    m.doors.push_back(
        library.Add({library.AddTexture(PaintDoor(next())), Finish::kMatte, false, 1, 0.2F}));
  for (int i = 0; i < 40; ++i)
    m.signs.push_back(
        library.Add({library.AddTexture(PaintSign(next())), Finish::kMatte, false, 1, 0.2F}));
  for (int i = 0; i < 16; ++i)
    m.posters.push_back(
        library.Add({library.AddTexture(PaintPoster(next())), Finish::kMatte, false, 1, 0.2F}));
  for (int i = 0; i < 24; ++i)
    m.house_numbers.push_back(
        library.Add({library.AddTexture(PaintHouseNumber(next())), Finish::kMatte, false, 1, 0}));
  for (int i = 0; i < 10; ++i)
    m.murals.push_back(
        library.Add({library.AddTexture(PaintMural(next())), Finish::kMatte, true, 1, 0}));
  m.number_plate =
      library.Add({library.AddTexture(PaintNumberPlate(next())), Finish::kMatte, false, 1, 0});
  for (int i = 0; i < 5; ++i)
    m.leaves.push_back(
        library.Add({library.AddTexture(PaintLeaves(next())), Finish::kFoliage, true, 1, 0}));
  return m;
}

}  // namespace orb360::town
