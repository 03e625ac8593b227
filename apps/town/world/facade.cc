#include "apps/town/world/facade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "apps/town/world/hedge.h"
#include "apps/town/world/opening.h"
#include "apps/town/world/shop_front.h"

namespace orb360::town {
namespace {

MaterialId PickFrom(Random& random, const std::vector<MaterialId>& values) {
  return random.Pick(std::span<const MaterialId>(values));
}

/// Factor on the tint at the foot of a wall, which the street splashes.
constexpr float kSplash = 0.68F;

/// Adds a bay that protrudes by `out` from the wall between `left` and `right`, with a window in
/// front and side walls; `lowest` and `highest` close it below and above.
void AddOriel(MeshBuilder& b, const FacadeStyle& style, const Panel& p, const WallPiece& piece,
              const Opening& opening, bool lowest, bool highest, Random& random) {
  constexpr float kOut = 0.55F;  // metres
  Panel front = p;
  front.origin += kOut * p.out;
  AddWallWithOpening(b, style.wall, style.wall_tint, front, piece, opening, 0.5F * style.reveal);
  AddWindow(b, style.frame_tint, front, opening, 0.5F * style.reveal, true,
            PickFrom(random, b.materials().rooms), random);
  AddSurround(b, style, front, opening);
  b.set_tint(style.wall_tint);
  const Panel left{p.At(piece.left, 0), p.out, p.up, -p.right};
  const Panel right{p.At(piece.right, 0, kOut), -p.out, p.up, p.right};
  for (const Panel& cheek : {left, right})
    b.AddRectangle(style.wall, cheek, 0, kOut, piece.bottom, piece.top);
  b.set_tint(style.trim_tint);
  const MaterialId trim = b.materials().trim;
  if (lowest) {
    b.AddFace(trim, p.At(piece.left, piece.bottom), p.At(piece.right, piece.bottom),
              p.At(piece.right, piece.bottom, kOut), p.At(piece.left, piece.bottom, kOut));
    b.AddBox(trim, p, piece.left - 0.05F, piece.right + 0.05F, piece.bottom, piece.bottom + 0.14F,
             0, kOut + 0.06F);
  }
  if (highest) {
    b.AddBox(trim, p, piece.left - 0.08F, piece.right + 0.08F, piece.top - 0.35F, piece.top - 0.2F,
             0, kOut + 0.1F);
  }
}

void AddUpperFloor(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width,
                   float bottom, int floor, bool front, int oriel_bay, Random& random) {
  const float top = bottom + style.floor_height;
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const float bay = width / static_cast<float>(bays);
  for (int i = 0; i < bays; ++i) {
    const float left = bay * static_cast<float>(i);
    const float x0 = left + 0.5F * (bay - style.window_width);
    const bool balcony =
        front && style.balconies && floor >= 1 && i % 2 == floor % 2 && bays > 1 && i != oriel_bay;
    const Opening opening{x0, x0 + style.window_width, bottom + (balcony ? 0.05F : style.sill),
                          bottom + style.sill + style.window_height};
    const WallPiece piece{left, left + bay, bottom, top};
    if (i == oriel_bay) {
      AddOriel(b, style, p, piece, opening, floor == 0, floor + 2 == style.floors, random);
      continue;
    }
    AddWallWithOpening(b, style.wall, style.wall_tint, p, piece, opening, style.reveal);
    AddWindow(b, style.frame_tint, p, opening, style.reveal, style.window_width > 0.9F,
              PickFrom(random, b.materials().rooms), random);
    if (balcony) {
      const float beyond = style.balcony == BalconyKind::kFrench ? 0.05F : 0.45F;
      AddBalcony(b, style, p, opening.x0 - beyond, opening.x1 + beyond, bottom + 0.03F, random);
    } else {
      AddSurround(b, style, p, opening);
      if (front && random.Chance(0.06)) AddFlowerBox(b, p, opening, random);
    }
    if (style.shutters && !balcony) {
      const float half = 0.5F * style.window_width;
      b.set_tint(style.shutter_tint);
      for (const float x : {opening.x0 - half, opening.x1 + 0.02F}) {
        const float end = x + half - 0.02F;
        b.AddBox(b.materials().trim, p, x, end, opening.z0, opening.z1, 0, 0.045F);
        b.AddImage(b.materials().louvres, p, x, end, opening.z0, opening.z1, 0.047F);
      }
    }
    if (random.Chance(0.03)) {  // air conditioner
      b.set_tint({0.6F, 0.6F, 0.58F, 1});
      b.AddBox(b.materials().trim, p, x0, x0 + 0.8F, opening.z0 - 0.75F, opening.z0 - 0.2F, 0.05F,
               0.4F);
    }
  }
}

void AddDoor(MeshBuilder& b, const FacadeStyle& style, const Panel& p, const Opening& o, float drop,
             Random& random) {
  const Materials& m = b.materials();
  b.set_tint({1, 1, 1, 1});
  b.AddImage(PickFrom(random, m.doors), p, o.x0, o.x1, o.z0, o.z1, -style.reveal);
  b.AddImage(PickFrom(random, m.house_numbers), p, o.x1 + 0.2F, o.x1 + 0.38F, 1.75F, 1.93F, 0.012F);
  b.set_tint(style.trim_tint);
  AddSteps(b, p, o.x0 - 0.2F, o.x1 + 0.2F, o.z0, drop);
  if (style.surrounds) {
    b.AddBox(m.trim, p, o.x0 - 0.2F, o.x0, o.z0, o.z1, 0, 0.08F);
    b.AddBox(m.trim, p, o.x1, o.x1 + 0.2F - 0.02F, o.z0, o.z1, 0, 0.08F);
    b.AddBox(m.trim, p, o.x0 - 0.3F, o.x1 + 0.3F, o.z1, o.z1 + 0.3F, 0, 0.16F);
  } else {
    b.AddBox(m.trim, p, o.x0 - 0.3F, o.x1 + 0.3F, o.z1 + 0.15F, o.z1 + 0.25F, 0, 0.7F);
  }
}

void AddGroundFloor(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width,
                    float drop, bool front, Random& random) {
  const Materials& m = b.materials();
  const float height = style.ground_height;
  if (front && style.shops) {
    const int shops = std::max(1, static_cast<int>(width / 6.5F));
    for (int i = 0; i < shops; ++i) {
      AddShopFront(b, style, p, width * static_cast<float>(i) / static_cast<float>(shops),
                   width * static_cast<float>(i + 1) / static_cast<float>(shops), drop, random);
    }
    return;
  }
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const float bay = width / static_cast<float>(bays);
  const int door_bay = front ? random.Int(bays) : -1;
  for (int i = 0; i < bays; ++i) {
    const float left = bay * static_cast<float>(i);
    const bool door = i == door_bay;
    const float size = door ? 1.15F : style.window_width;
    const float x0 = left + 0.5F * (bay - size);
    const Opening opening{x0, x0 + size, door ? 0.15F : 1.0F,
                          door ? 2.45F : std::min(height - 0.5F, 1.0F + style.window_height)};
    AddWallWithOpening(b, style.ground_wall, style.ground_tint, p, {left, left + bay, 0, height},
                       opening, style.reveal, kSplash);
    if (door) {
      AddDoor(b, style, p, opening, drop, random);
      continue;
    }
    AddWindow(b, style.frame_tint, p, opening, style.reveal, true, PickFrom(random, m.rooms),
              random);
    AddSurround(b, style, p, opening);
    if (front && random.Chance(0.08)) {
      b.set_tint({1, 1, 1, 1});
      b.AddImage(PickFrom(random, m.posters), p, left + 0.05F, left + 0.5F, 0.9F, 1.8F, 0.008F);
    }
  }
}

void AddPlinth(MeshBuilder& b, const Panel& p, float width, float drop, Random& random) {
  const MaterialId concrete = b.materials().concrete;
  b.set_texture_origin(
      {static_cast<float>(random.Uniform(0, 50)), static_cast<float>(random.Uniform(0, 50))});
  b.set_tint({0.62F, 0.61F, 0.59F, 1});
  AddWeatheredRectangle(b, concrete, p, {0, width, -drop - 1, 0}, 0.8F, 1);
  b.AddBox(concrete, p, 0, width, -drop - 1, 0.3F, -0.01F, 0.05F);
}

void AddCornice(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width) {
  const float eaves = EavesHeight(style);
  const MaterialId trim = b.materials().trim;
  b.set_tint(style.trim_tint);
  b.AddBox(trim, p, -0.02F, width + 0.02F, eaves - 0.28F, eaves - 0.1F, 0, 0.15F);
  b.AddBox(trim, p, -0.02F, width + 0.02F, eaves - 0.1F, eaves + 0.08F, 0, 0.32F);
}

void AddDrainPipe(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float x, float drop) {
  const float eaves = EavesHeight(style);
  b.set_tint({0.22F, 0.21F, 0.2F, 1});
  const MaterialId metal = b.materials().metal;
  b.AddTube(metal, p.At(x, -drop, 0.12F), p.At(x, eaves - 0.3F, 0.12F), 0.05F, 0.05F, 6);
  b.AddTube(metal, p.At(x, eaves - 0.3F, 0.12F), p.At(x, eaves - 0.05F, 0.3F), 0.06F, 0.09F, 6);
}

}  // namespace

void AddFront(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
              Random& random) {
  AddPlinth(b, p, width, drop, random);
  AddGroundFloor(b, style, p, width, drop, true, random);
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const int oriel_bay = style.oriels ? random.Int(bays) : -1;
  for (int floor = 0; floor < style.floors - 1; ++floor) {
    AddUpperFloor(b, style, p, width,
                  style.ground_height + style.floor_height * static_cast<float>(floor), floor, true,
                  oriel_bay, random);
  }
  const Materials& m = b.materials();
  b.set_tint(style.trim_tint);
  if (style.bands) {
    for (int floor = 0; floor + 1 < style.floors; ++floor) {
      const float z = style.ground_height + style.floor_height * static_cast<float>(floor);
      b.AddBox(m.trim, p, 0, width, z - 0.12F, z + 0.06F, 0, 0.06F);
    }
  }
  if (style.quoins) {
    for (float z = 0.35F; z + 0.5F < EavesHeight(style); z += 0.5F) {
      const float length = std::lround(z / 0.5F) % 2 == 0 ? 0.55F : 0.32F;
      b.AddBox(m.ashlar, p, 0, length, z, z + 0.46F, 0, 0.035F);
      b.AddBox(m.ashlar, p, width - length, width, z, z + 0.46F, 0, 0.035F);
    }
  }
  AddCornice(b, style, p, width);
  AddDrainPipe(b, style, p, 0.12F, drop);
}

void AddSide(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
             bool has_windows, Random& random) {
  const Materials& m = b.materials();
  AddPlinth(b, p, width, drop, random);
  const float eaves = EavesHeight(style);
  if (has_windows) {
    AddGroundFloor(b, style, p, width, drop, false, random);
    for (int floor = 0; floor < style.floors - 1; ++floor) {
      AddUpperFloor(b, style, p, width,
                    style.ground_height + style.floor_height * static_cast<float>(floor), floor,
                    false, -1, random);
    }
    return;
  }
  b.set_tint(style.ground_tint);
  AddWeatheredRectangle(b, style.ground_wall, p, {0, width, 0, style.ground_height}, kSplash, 1);
  b.set_tint(style.wall_tint);
  AddWeatheredRectangle(b, style.wall, p, {0, width, style.ground_height, eaves}, 1, 0.85F);
  // Small windows of a staircase or of bathrooms, one above the other.
  const bool mural = random.Chance(0.45) && eaves > 7;
  const int columns = mural ? 0 : random.Int(3);
  for (int column = 0; column < columns; ++column) {
    const float x = width * (0.2F + 0.25F * static_cast<float>(column + random.Int(2)));
    for (int floor = 0; floor + 1 < style.floors; ++floor) {
      if (random.Chance(0.2)) continue;
      const float z =
          style.ground_height + style.floor_height * static_cast<float>(floor) + style.sill + 0.3F;
      const Opening window{x, x + 0.65F, z, z + 0.9F};
      b.set_tint(style.frame_tint);
      b.AddRectangle(m.trim, p, window.x0 - 0.06F, window.x1 + 0.06F, window.z0 - 0.06F,
                     window.z1 + 0.06F, 0.01F);
      AddPane(b, PickFrom(random, m.rooms), p, window, 0.02F, random);
      b.set_tint(style.trim_tint);
      b.AddBox(m.trim, p, x - 0.1F, x + 0.75F, z - 0.12F, z - 0.06F, 0, 0.08F);
    }
  }
  if (mural) {
    const float size = std::min({width - 1.6F, eaves - 4.2F, 6.5F});
    const float x = 0.5F * (width - size);
    b.set_tint({1, 1, 1, 1});
    b.AddImage(PickFrom(random, m.murals), p, x, x + size, eaves - size - 0.8F, eaves - 0.8F,
               0.01F);
  } else if (style.ivy) {
    AddIvy(b, p, width, eaves, random);
  }
  AddDrainPipe(b, style, p, random.Chance(0.5) ? 0.3F : width - 0.3F, drop);
}

void AddBack(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
             Random& random) {
  const float eaves = EavesHeight(style);
  b.set_texture_origin({static_cast<float>(random.Uniform(0, 50)), 0});
  b.set_tint(style.wall_tint);
  b.AddRectangle(style.wall, p, 0, width, -drop - 1, eaves + 0.08F);
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const float bay = width / static_cast<float>(bays);
  for (int floor = 0; floor < style.floors; ++floor) {
    const float bottom =
        floor == 0 ? 0 : style.ground_height + style.floor_height * static_cast<float>(floor - 1);
    for (int i = 0; i < bays; ++i) {
      const float x0 = bay * static_cast<float>(i) + 0.5F * (bay - style.window_width);
      const float z0 = bottom + style.sill;
      b.set_tint(style.frame_tint);
      b.AddRectangle(b.materials().trim, p, x0, x0 + style.window_width, z0,
                     z0 + style.window_height, 0.01F);
      b.set_tint({1, 1, 1, 1});
      AddPane(b, PickFrom(random, b.materials().rooms), p,
              {x0 + 0.07F, x0 + style.window_width - 0.07F, z0 + 0.07F,
               z0 + style.window_height - 0.07F},
              0.02F, random);
    }
  }
}

}  // namespace orb360::town
