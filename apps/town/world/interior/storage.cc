#include <algorithm>
#include <cmath>

#include "apps/town/world/interior/furniture.h"

namespace orb360::town {

void AddCupboard(Kit& kit, const Panel& p, float width, float depth, float height,
                 bool has_drawers) {
  AddSolid(kit.b, kit.Use(kit.wood), p, 0, width, 0.06F, height, 0, depth);
  AddSolid(kit.b, kit.UseGrey(0.05F), p, 0.02F, width - 0.02F, 0, 0.06F, 0.01F, depth - 0.04F);
  const int columns = std::max(1, static_cast<int>(std::lround(width / kit.Draw(0.4, 0.7))));
  const int rows = has_drawers ? std::max(2, static_cast<int>(height / kit.Draw(0.18, 0.28)))
                               : (height > 1.9F && kit.random.Chance(0.3) ? 2 : 1);
  const bool has_knobs = kit.random.Chance(0.5);
  for (int i = 0; i < columns; ++i) {
    for (int k = 0; k < rows; ++k) {
      const float x0 = width * static_cast<float>(i) / static_cast<float>(columns) + 0.004F;
      const float x1 = width * static_cast<float>(i + 1) / static_cast<float>(columns) - 0.004F;
      const float z0 =
          0.07F + (height - 0.08F) * static_cast<float>(k) / static_cast<float>(rows) + 0.004F;
      const float z1 =
          0.07F + (height - 0.08F) * static_cast<float>(k + 1) / static_cast<float>(rows) - 0.004F;
      kit.b.set_texture_origin({kit.Draw(0, 3), kit.Draw(0, 3)});
      kit.b.AddBox(kit.Use(kit.second), p, x0, x1, z0, z1, depth, depth + 0.02F);
      kit.b.set_texture_origin({0, 0});
      const MaterialId handle = kit.Use(kit.metal);
      const float z = has_drawers ? 0.5F * (z0 + z1) : z0 + std::min(0.55F * (z1 - z0), 1.0F);
      const float x = has_drawers ? 0.5F * (x0 + x1) : (i % 2 == 0 ? x1 - 0.05F : x0 + 0.05F);
      if (has_knobs)
        kit.b.AddEllipsoid(handle, p.At(x, z, depth + 0.035F), {0.016F, 0.016F, 0.016F});
      else if (has_drawers)
        AddSolid(kit.b, handle, p, x - 0.07F, x + 0.07F, z - 0.006F, z + 0.006F, depth + 0.03F,
                 depth + 0.045F);
      else
        AddSolid(kit.b, handle, p, x - 0.007F, x + 0.007F, z - 0.08F, z + 0.08F, depth + 0.03F,
                 depth + 0.045F);
    }
  }
  if (height < 1.3F)
    AddClutter(kit, p, 0.02F, width - 0.02F, 0.02F, depth - 0.02F, height, kit.random.Int(6));
  else if (kit.random.Chance(0.4))
    AddCartons(kit, Turned(p, 0.05F, 0.03F, 0, height), std::min(width - 0.1F, 0.9F), depth - 0.05F,
               0.25F);
}

void AddBookcase(Kit& kit, const Panel& p, float width, float depth, float height) {
  constexpr float kBoard = 0.022F;  // metres
  const bool has_back = kit.random.Chance(0.8);
  const int bays = std::max(1, static_cast<int>(std::lround(width / 0.85F)));
  const MaterialId wood = kit.Use(kit.wood);
  if (has_back) AddSolid(kit.b, wood, p, 0, width, 0, height, 0, 0.012F);
  for (int i = 0; i <= bays; ++i) {
    const float x = (width - kBoard) * static_cast<float>(i) / static_cast<float>(bays);
    AddSolid(kit.b, wood, p, x, x + kBoard, 0, height, 0, depth);
  }
  const int shelves = std::max(2, static_cast<int>(height / kit.Draw(0.3, 0.42)));
  const float step = (height - kBoard - 0.06F) / static_cast<float>(shelves);
  const float fullness = kit.Draw(0.35, 1);
  for (int k = 0; k <= shelves; ++k) {
    const float z = 0.06F + step * static_cast<float>(k);
    AddSolid(kit.b, kit.Use(kit.wood), p, kBoard, width - kBoard, z, z + kBoard, 0.012F,
             depth - 0.004F);
    if (k == shelves) break;
    for (int i = 0; i < bays; ++i) {
      const float x0 = (width - kBoard) * static_cast<float>(i) / static_cast<float>(bays) + kBoard;
      const float x1 = (width - kBoard) * static_cast<float>(i + 1) / static_cast<float>(bays);
      const float top = z + kBoard;
      if (!kit.random.Chance(fullness)) continue;
      if (kit.random.Chance(0.3)) {
        AddClutter(kit, p, x0, x1, 0.03F, depth - 0.03F, top, 1 + kit.random.Int(4));
        continue;
      }
      // Groups of books of one height; the image of one group spans its front.
      float x = x0 + 0.005F;
      const float end = x0 + (x1 - x0) * kit.Draw(0.5, 1);
      while (x < end - 0.08F) {
        const float right = std::min(end, x + kit.Draw(0.1, 0.4));
        const float tall = std::min(step - kBoard - 0.02F, kit.Draw(0.17, 0.31));
        const float front = std::min(depth - 0.02F, kit.Draw(0.12, 0.22));
        kit.b.set_tint({0.85F, 0.82F, 0.75F, 1});
        AddSolid(kit.b, kit.m.plain, p, x, right, top, top + 0.97F * tall, 0.02F, front - 0.004F);
        kit.b.set_tint({1, 1, 1, 1});
        const auto u = kit.Draw(0, 1);
        const float v = (right - x) / 0.9F;
        kit.b.AddQuad(
            kit.Pick(kit.m.books),
            {p.At(x, top, front), p.At(right, top, front), p.At(right, top + tall, front),
             p.At(x, top + tall, front)},
            {Vector2f(u, 0), Vector2f(u + v, 0), Vector2f(u + v, 0.98F), Vector2f(u, 0.98F)});
        x = right + (kit.random.Chance(0.3) ? kit.Draw(0.01, 0.1) : 0.001F);
      }
    }
  }
}

void AddCartons(Kit& kit, const Panel& p, float width, float depth, float height) {
  float z = 0;
  while (z < height - 0.08F) {
    const float tall = std::min(height - z, kit.Draw(0.18, 0.5));
    float x = kit.Draw(0, 0.15) * width;
    while (x < width - 0.15F) {
      const float wide = std::min(width - x, kit.Draw(0.2, 0.7));
      const float deep = depth * kit.Draw(0.75, 1);
      if (wide > 0.12F && (z < 0.01F || kit.random.Chance(0.75))) {
        const float away = kit.Draw(0, 1) * (depth - deep);
        const Panel box = Turned(p, x, away, kit.Draw(-0.06, 0.06), z);
        const float shade = kit.Draw(0.7, 1);
        kit.b.set_tint({shade, shade, shade, 1});
        const MaterialId carton = kit.Pick(kit.m.cartons);
        const float w = wide - 0.02F;
        const float t = tall * kit.Draw(0.8, 1);
        kit.b.AddImage(carton, box, 0, w, 0, t, deep);
        kit.b.AddImage(carton, {box.At(w, 0, 0), -box.right, box.up, -box.out}, 0, w, 0, t, 0);
        kit.b.AddImage(carton, {box.At(w, 0, deep), -box.out, box.up, box.right}, 0, deep, 0, t, 0);
        kit.b.AddImage(carton, {box.At(0, 0, 0), box.out, box.up, -box.right}, 0, deep, 0, t, 0);
        kit.b.AddImage(carton, {box.At(0, t, deep), box.right, -box.out, box.up}, 0, w, 0, deep, 0);
      }
      x += wide;
    }
    z += tall;
  }
}

void AddRack(Kit& kit, const Panel& p, float width, float depth, float height) {
  const bool is_blue = kit.random.Chance(0.5);
  const Rgba post_tint = is_blue ? Rgba{0.05F, 0.12F, 0.4F, 1} : Rgba{0.4F, 0.4F, 0.4F, 1};
  const Rgba beam_tint = is_blue ? Rgba{0.7F, 0.22F, 0.03F, 1} : Rgba{0.45F, 0.45F, 0.44F, 1};
  const int bays =
      std::max(1, static_cast<int>(std::lround(width / (height > 2.6F ? 2.6F : 1.2F))));
  const float side = height > 2.6F ? 0.09F : 0.045F;
  for (int i = 0; i <= bays; ++i) {
    const float x = (width - side) * static_cast<float>(i) / static_cast<float>(bays);
    kit.b.set_tint(post_tint);
    for (const float d : {0.0F, depth - side})
      AddSolid(kit.b, kit.m.plain, p, x, x + side, 0, height, d, d + side);
    for (float z = 0.3F; z < height - 0.5F; z += 0.9F)
      kit.b.AddTube(kit.m.plain, p.At(x + 0.5F * side, z, 0.02F),
                    p.At(x + 0.5F * side, z + 0.7F, depth - 0.02F), 0.018F, 0.018F, 6);
  }
  const float step = height > 2.6F ? kit.Draw(1.2, 1.7) : kit.Draw(0.4, 0.65);
  const float fullness = kit.Draw(0.3, 0.95);
  for (float z = height > 2.6F ? 0.0F : 0.1F; z < height - 0.2F; z += step) {
    kit.b.set_tint(beam_tint);
    if (z > 0.05F) {
      for (const float d : {0.0F, depth - 0.05F})
        AddSolid(kit.b, kit.m.plain, p, 0, width, z - 0.1F, z, d, d + 0.05F);
      AddSolid(kit.b, kit.Use(kit.wood), p, 0.02F, width - 0.02F, z, z + 0.02F, 0.02F,
               depth - 0.02F);
    }
    for (int i = 0; i < bays; ++i) {
      const float bay = width / static_cast<float>(bays);
      if (!kit.random.Chance(fullness)) continue;
      const float x = bay * static_cast<float>(i) + side + 0.03F;
      const float wide = (bay - 2 * side) * kit.Draw(0.5, 0.98);
      AddCartons(kit, Turned(p, x, 0.06F, 0, z + 0.02F), wide, depth - 0.12F,
                 (step - 0.2F) * kit.Draw(0.3, 1));
    }
  }
}

void AddLockers(Kit& kit, const Panel& p, float width, float depth, float height) {
  const int count = std::max(1, static_cast<int>(std::lround(width / 0.38F)));
  const float grey = kit.Draw(0.2, 0.6);
  const Rgba door = kit.random.Chance(0.5)
                        ? Rgba{grey, grey, grey, 1}
                        : Rgba{kit.Draw(0.05, 0.5), kit.Draw(0.1, 0.4), kit.Draw(0.1, 0.5), 1};
  AddSolid(kit.b, kit.UseGrey(grey), p, 0, width, 0, height, 0, depth);
  for (int i = 0; i < count; ++i) {
    const float x0 = width * static_cast<float>(i) / static_cast<float>(count) + 0.008F;
    const float x1 = width * static_cast<float>(i + 1) / static_cast<float>(count) - 0.008F;
    kit.b.set_tint(door);
    kit.b.AddBox(kit.m.plain, p, x0, x1, 0.1F, height - 0.02F, depth, depth + 0.012F);
    for (int k = 0; k < 5; ++k)
      kit.b.AddBox(kit.UseGrey(0.02F), p, x0 + 0.08F, x1 - 0.08F,
                   height - 0.3F + 0.03F * static_cast<float>(k),
                   height - 0.29F + 0.03F * static_cast<float>(k), depth + 0.012F, depth + 0.014F);
    kit.b.AddBox(kit.UseGrey(0.4F), p, x1 - 0.06F, x1 - 0.04F, 0.9F, 1.0F, depth + 0.012F,
                 depth + 0.03F);
  }
}

}  // namespace orb360::town
