#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/town/world/interior/furniture.h"

namespace orb360::town {
namespace {

/// Adds a basin without lid: a rectangular trough sunk into z.
void AddTrough(Kit& kit, MaterialId material, const Panel& p, float x0, float x1, float depth0,
               float depth1, float z, float deep) {
  const float x2 = x0 + 0.15F * (x1 - x0);
  const float x3 = x1 - 0.15F * (x1 - x0);
  const float d2 = depth0 + 0.15F * (depth1 - depth0);
  const float d3 = depth1 - 0.15F * (depth1 - depth0);
  const float low = z - deep;
  kit.b.AddFace(material, p.At(x2, low, d3), p.At(x3, low, d3), p.At(x3, low, d2),
                p.At(x2, low, d2));
  kit.b.AddFace(material, p.At(x2, low, d2), p.At(x3, low, d2), p.At(x1, z, depth0),
                p.At(x0, z, depth0));
  kit.b.AddFace(material, p.At(x3, low, d3), p.At(x2, low, d3), p.At(x0, z, depth1),
                p.At(x1, z, depth1));
  kit.b.AddFace(material, p.At(x2, low, d3), p.At(x2, low, d2), p.At(x0, z, depth0),
                p.At(x0, z, depth1));
  kit.b.AddFace(material, p.At(x3, low, d2), p.At(x3, low, d3), p.At(x1, z, depth1),
                p.At(x1, z, depth0));
}

/// Adds the four sides of a body around a trough, and its rim.
void AddRim(Kit& kit, MaterialId material, const Panel& p, float width, float depth, float low,
            float z, float rim) {
  kit.b.AddRectangle(material, p, 0, width, low, z, depth);
  kit.b.AddFace(material, p.At(0, low, 0), p.At(0, low, depth), p.At(0, z, depth), p.At(0, z, 0));
  kit.b.AddFace(material, p.At(width, low, depth), p.At(width, low, 0), p.At(width, z, 0),
                p.At(width, z, depth));
  const auto top = [&](float x0, float x1, float d0, float d1) {
    kit.b.AddFace(material, p.At(x0, z, d1), p.At(x1, z, d1), p.At(x1, z, d0), p.At(x0, z, d0));
  };
  top(0, width, 0, rim);
  top(0, width, depth - rim, depth);
  top(0, rim, rim, depth - rim);
  top(width - rim, width, rim, depth - rim);
}

void AddTap(Kit& kit, const Panel& p, float x, float depth, float z) {
  const MaterialId steel = kit.UseGrey(0.5F);
  kit.b.AddTube(steel, p.At(x, z, depth), p.At(x, z + 0.16F, depth), 0.014F, 0.012F, 8);
  kit.b.AddTube(steel, p.At(x, z + 0.16F, depth), p.At(x, z + 0.14F, depth + 0.13F), 0.011F, 0.011F,
                8);
}

}  // namespace

void AddKitchen(Kit& kit, const Panel& p, float width, float depth, float ceiling,
                bool has_wall_units) {
  const Coat front = kit.second;
  const Rgba top{kit.Draw(0.05, 0.6), kit.Draw(0.05, 0.5), kit.Draw(0.04, 0.4), 1};
  const float fridge = width > 2 ? 0.6F : 0;
  if (fridge > 0) {
    const float tall = std::min(ceiling - 0.1F, kit.Draw(1.4, 2.05));
    const MaterialId white = kit.UseGrey(kit.random.Chance(0.7) ? 0.8F : 0.3F);
    AddSolid(kit.b, white, p, 0, fridge, 0.02F, tall, 0, depth - 0.02F);
    kit.b.AddBox(white, p, 0.005F, fridge - 0.005F, 0.05F, 0.4F * tall, depth - 0.02F,
                 depth + 0.03F);
    kit.b.AddBox(white, p, 0.005F, fridge - 0.005F, 0.4F * tall + 0.01F, tall - 0.01F,
                 depth - 0.02F, depth + 0.03F);
    AddSolid(kit.b, kit.UseGrey(0.4F), p, 0.04F, 0.06F, 0.45F * tall, 0.75F * tall, depth + 0.05F,
             depth + 0.07F);
  }
  const float height = kit.Draw(0.84, 0.92);
  const int units = std::max(2, static_cast<int>(std::lround((width - fridge) / 0.55F)));
  const float unit = (width - fridge) / static_cast<float>(units);
  AddSolid(kit.b, kit.UseGrey(0.05F), p, fridge, width, 0, 0.1F, 0.02F, depth - 0.06F);
  AddSolid(kit.b, kit.Use(kit.wood), p, fridge, width, 0.1F, height - 0.04F, 0, depth - 0.03F);
  const int stove = kit.random.Int(units);
  const int sink = (stove + 1 + kit.random.Int(units - 1)) % units;
  for (int i = 0; i < units; ++i) {
    const float x0 = fridge + unit * static_cast<float>(i);
    const float x1 = x0 + unit;
    const MaterialId handle = kit.Use(kit.metal);
    AddSolid(kit.b, handle, p, x0 + 0.15F, x1 - 0.15F, height - 0.12F, height - 0.105F,
             depth + 0.01F, depth + 0.03F);
    if (i == stove) {
      kit.b.AddBox(kit.UseGrey(0.02F), p, x0 + 0.005F, x1 - 0.005F, 0.13F, height - 0.06F,
                   depth - 0.03F, depth - 0.005F);
      kit.b.AddBox(kit.UseGrey(0.015F), p, x0 + 0.02F, x1 - 0.02F, height, height + 0.006F, 0.06F,
                   depth - 0.06F);
      for (int k = 0; k < 4; ++k)
        AddDrum(kit.b, kit.UseGrey(0.04F),
                p.At(x0 + unit * (k % 2 == 0 ? 0.28F : 0.72F), height + 0.006F,
                     depth * (k < 2 ? 0.3F : 0.68F)),
                0.08F, 0.008F, 16);
      if (kit.random.Chance(0.6))
        AddDrum(kit.b, kit.UseGrey(kit.Draw(0.05, 0.5)),
                p.At(x0 + 0.28F * unit, height + 0.014F, 0.68F * depth), 0.1F, 0.13F, 18);
    } else {
      const int drawers = kit.random.Chance(0.3) ? 3 : 1;
      for (int k = 0; k < drawers; ++k) {
        const float z0 =
            0.11F + (height - 0.16F) * static_cast<float>(k) / static_cast<float>(drawers);
        const float z1 =
            0.11F + (height - 0.16F) * static_cast<float>(k + 1) / static_cast<float>(drawers);
        kit.b.AddBox(kit.Use(front), p, x0 + 0.003F, x1 - 0.003F, z0 + 0.003F, z1 - 0.003F,
                     depth - 0.03F, depth - 0.01F);
      }
    }
    kit.b.set_tint(top);
    const MaterialId worktop = kit.m.plain;
    if (i == sink) {
      const MaterialId steel = kit.UseGrey(0.45F);
      AddTrough(kit, steel, p, x0 + 0.06F, x1 - 0.06F, 0.12F, depth - 0.1F, height, 0.15F);
      kit.b.set_tint(top);
      AddSolid(kit.b, worktop, p, x0, x1, height - 0.04F, height, 0, 0.12F);
      AddSolid(kit.b, worktop, p, x0, x1, height - 0.04F, height, depth - 0.1F, depth);
      AddSolid(kit.b, worktop, p, x0, x0 + 0.06F, height - 0.04F, height, 0.12F, depth - 0.1F);
      AddSolid(kit.b, worktop, p, x1 - 0.06F, x1, height - 0.04F, height, 0.12F, depth - 0.1F);
      AddTap(kit, p, 0.5F * (x0 + x1), 0.07F, height);
    } else {
      AddSolid(kit.b, worktop, p, x0, x1, height - 0.04F, height, 0, depth);
      if (i != stove) AddClutter(kit, p, x0, x1, 0.02F, depth - 0.1F, height, kit.random.Int(4));
    }
    if (!has_wall_units || ceiling < 2.1F || kit.random.Chance(0.12)) continue;
    const float low = height + 0.52F;
    const float high = std::min(ceiling - 0.05F, low + 0.72F);
    if (i == stove) {
      AddSolid(kit.b, kit.UseGrey(0.5F), p, x0 + 0.01F, x1 - 0.01F, low + 0.15F, low + 0.24F, 0,
               0.45F);
      AddSolid(kit.b, kit.UseGrey(0.5F), p, x0 + 0.17F, x1 - 0.17F, low + 0.24F, high, 0, 0.28F);
      continue;
    }
    AddSolid(kit.b, kit.Use(kit.wood), p, x0, x1, low, high, 0, 0.32F);
    kit.b.AddBox(kit.Use(front), p, x0 + 0.003F, x1 - 0.003F, low + 0.003F, high - 0.003F, 0.32F,
                 0.34F);
    AddSolid(kit.b, kit.Use(kit.metal), p, x1 - 0.06F, x1 - 0.045F, low + 0.05F, low + 0.2F, 0.35F,
             0.365F);
  }
}

void AddBath(Kit& kit, const Panel& p, float width, float depth) {
  const MaterialId white = kit.UseGrey(0.85F);
  AddRim(kit, white, p, width, depth, 0, 0.58F, 0.07F);
  AddTrough(kit, white, p, 0.07F, width - 0.07F, 0.07F, depth - 0.07F, 0.58F, 0.42F);
  AddTap(kit, p, 0.5F * width, 0.05F, 0.58F);
}

void AddBasin(Kit& kit, const Panel& p, float width, float depth) {
  const MaterialId white = kit.UseGrey(0.85F);
  AddRim(kit, white, p, width, depth, 0.7F, 0.85F, 0.05F);
  AddTrough(kit, white, p, 0.05F, width - 0.05F, 0.05F, depth - 0.05F, 0.85F, 0.13F);
  AddTap(kit, p, 0.5F * width, 0.03F, 0.85F);
  if (kit.random.Chance(0.5))
    AddCupboard(kit, p, width, depth - 0.03F, 0.7F, false);
  else
    kit.b.AddTube(kit.UseGrey(0.8F), p.At(0.5F * width, 0, 0.15F), p.At(0.5F * width, 0.72F, 0.15F),
                  0.09F, 0.07F, 14);
  // A cabinet stands for the mirror above.
  AddSolid(kit.b, kit.UseGrey(0.6F), p, 0.02F, width - 0.02F, 1.25F, 1.85F, 0, 0.13F);
  AddSolid(kit.b, kit.UseGrey(0.3F), p, 0.5F * width - 0.003F, 0.5F * width + 0.003F, 1.26F, 1.84F,
           0.13F, 0.133F);
}

void AddToilet(Kit& kit, const Panel& p, float width, float depth) {
  const MaterialId white = kit.UseGrey(0.85F);
  AddCushion(kit.b, white, p, 0.02F, width - 0.02F, 0.42F, 0.82F, 0, 0.18F);
  AddCushion(kit.b, white, p, 0.08F, width - 0.08F, 0, 0.38F, 0.12F, depth - 0.08F);
  AddCushion(kit.b, white, p, 0, width, 0.36F, 0.44F, 0.16F, depth);
}

void AddWashingMachine(Kit& kit, const Panel& p, float width, float depth) {
  const MaterialId white = kit.UseGrey(0.8F);
  AddSolid(kit.b, white, p, 0, width, 0.02F, 0.85F, 0, depth);
  const Vector3f middle = p.At(0.5F * width, 0.42F, depth);
  kit.b.AddTube(kit.UseGrey(0.4F), middle, middle + 0.04F * p.out, 0.2F, 0.17F, 22);
  kit.b.AddEllipsoid(
      kit.UseGrey(0.05F), middle,
      Vector3f(0.17F, 0.17F, 0.17F).cwiseProduct(Vector3f::Ones() - 0.75F * p.out.cwiseAbs()));
  kit.b.AddBox(kit.UseGrey(0.15F), p, 0.25F, width - 0.05F, 0.74F, 0.82F, depth, depth + 0.004F);
  AddClutter(kit, p, 0, width, 0, depth, 0.85F, kit.random.Int(4));
}

void AddPlant(Kit& kit, const Panel& p, float width, float height) {
  const Vector3f foot = p.At(0.5F * width, 0, 0.5F * width);
  const float pot = std::min(0.4F * height, 0.45F * width + 0.05F);
  kit.b.AddTube(kit.UseColour(), foot, foot + Vector3f(0, 0, pot), 0.3F * width, 0.42F * width, 18);
  kit.b.set_tint({0.08F, 0.05F, 0.03F, 1});
  AddDrum(kit.b, kit.m.plain, foot + Vector3f(0, 0, 0.5F * pot), 0.33F * width, 0.4F * pot);
  const MaterialId leaves = kit.Pick(kit.m.leaves);
  const int stems = 5 + kit.random.Int(8);
  for (int i = 0; i < stems; ++i) {
    const float angle = kit.Draw(0, 6.28);
    const Vector3f out(std::cos(angle), std::sin(angle), 0);
    const float reach = 0.45F * width * kit.Draw(0.2, 1);
    const float rise = kit.Draw(0.6, 1) * height;
    const Vector3f tip = foot + reach * out + Vector3f(0, 0, rise);
    const Vector3f start = foot + Vector3f(0, 0, 0.9F * pot);
    kit.b.set_tint({0.1F, 0.14F, 0.05F, 1});
    kit.b.AddTube(kit.m.plain, start, tip, 0.008F, 0.004F, 5);
    const float shade = kit.Draw(0.4, 0.9);
    kit.b.set_tint({shade * 0.8F, shade, shade * 0.6F, 1});
    for (int k = 0; k < 4; ++k) {
      const Vector3f at = start + (0.35F + 0.22F * static_cast<float>(k)) * (tip - start);
      const float size = width * kit.Draw(0.25, 0.45);
      const float turn = kit.Draw(0, 6.28);
      const Vector3f x(size * std::cos(turn), size * std::sin(turn), kit.Draw(-0.3, 0.3) * size);
      const Vector3f y = size * (out + Vector3f(0, 0, kit.Draw(0, 1))).normalized();
      kit.b.AddQuad(leaves, {at - x, at + x, at + x + y, at - x + y},
                    {Vector2f(0, 0), Vector2f(1, 0), Vector2f(1, 1), Vector2f(0, 1)});
    }
  }
}

void AddFloorLamp(Kit& kit, const Panel& p, float height, std::vector<Lamp>* lamps,
                  float radiance) {
  const MaterialId metal = kit.Use(kit.metal);
  AddDrum(kit.b, metal, p.At(0.2F, 0, 0.2F), 0.14F, 0.025F, 20);
  kit.b.AddTube(metal, p.At(0.2F, 0.02F, 0.2F), p.At(0.2F, height - 0.2F, 0.2F), 0.012F, 0.012F, 8);
  const bool is_lit = radiance > 0;
  kit.b.set_tint({0.95F, 0.85F, 0.65F, 1});
  const MaterialId shade = is_lit ? kit.m.lamp : kit.m.plain;
  kit.b.AddTube(shade, p.At(0.2F, height - 0.28F, 0.2F), p.At(0.2F, height, 0.2F), 0.19F, 0.12F,
                20);
  if (!is_lit) return;
  const Vector3f light = radiance * Vector3f(1, 0.8F, 0.55F);
  lamps->push_back(
      {p.At(0.08F, height + 0.01F, 0.32F), 0.24F * p.right, -0.24F * p.out, light, false});
  lamps->push_back(
      {p.At(0.06F, height - 0.3F, 0.06F), 0.28F * p.right, 0.28F * p.out, 0.5F * light, false});
}

void AddTelevision(Kit& kit, const Panel& p, float width, float depth) {
  const float board = kit.Draw(0.35, 0.55);
  AddCupboard(kit, p, width, depth, board, kit.random.Chance(0.5));
  const float wide = std::min(width - 0.1F, kit.Draw(0.8, 1.5));
  const float x = 0.5F * (width - wide);
  const MaterialId dark = kit.UseGrey(0.012F);
  AddSolid(kit.b, dark, p, 0.5F * width - 0.2F, 0.5F * width + 0.2F, 0.5F, 0.62F, 0.2F, 0.26F);
  AddSolid(kit.b, dark, p, x, x + wide, 0.62F, 0.62F + 0.58F * wide, 0.2F, 0.24F);
  if (!kit.random.Chance(0.4)) return;
  kit.b.set_tint({1, 1, 1, 1});
  kit.b.AddImage(kit.Pick(kit.m.pictures), p, x + 0.015F, x + wide - 0.015F, 0.635F,
                 0.605F + 0.58F * wide, 0.2415F);
}

void AddBarrel(Kit& kit, const Panel& p, float width) {
  const Vector3f foot = p.At(0.5F * width, 0, 0.5F * width);
  const MaterialId colour = kit.UseColour();
  AddDrum(kit.b, colour, foot, 0.47F * width, 0.88F, 24);
  for (const float z : {0.02F, 0.3F, 0.58F, 0.85F})
    kit.b.AddTube(colour, foot + Vector3f(0, 0, z), foot + Vector3f(0, 0, z + 0.03F), 0.5F * width,
                  0.5F * width, 24);
}

}  // namespace orb360::town
