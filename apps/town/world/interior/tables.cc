#include <algorithm>

#include "apps/town/world/interior/furniture.h"

namespace orb360::town {

void AddClutter(Kit& kit, const Panel& p, float x0, float x1, float depth0, float depth1, float z,
                int count) {
  for (int i = 0; i < count; ++i) {
    const float x = kit.Draw(x0 + 0.08, std::max(x0 + 0.09F, x1 - 0.08F));
    const float depth = kit.Draw(depth0 + 0.08, std::max(depth0 + 0.09F, depth1 - 0.08F));
    const Panel at = Turned(p, x, depth, kit.Draw(-1.5, 1.5), z);
    switch (kit.random.Int(6)) {
      case 0: {  // a cup
        const MaterialId china = kit.UseColour();
        const float radius = kit.Draw(0.03, 0.05);
        AddDrum(kit.b, china, at.origin, radius, kit.Draw(0.07, 0.12));
        break;
      }
      case 1: {  // a bottle
        const float radius = kit.Draw(0.025, 0.045);
        const float tall = kit.Draw(0.13, 0.22);
        const MaterialId glass = kit.UseColour();
        AddDrum(kit.b, glass, at.origin, radius, tall, 12);
        kit.b.AddTube(glass, at.At(0, tall), at.At(0, tall + 0.07F), 0.7F * radius, 0.012F, 10);
        break;
      }
      case 2: {  // a pile of books
        float top = 0;
        for (int k = 1 + kit.random.Int(5); k > 0; --k) {
          const float thick = kit.Draw(0.012, 0.045);
          const Panel book = Turned(at, 0, 0, kit.Draw(-0.15, 0.15), top);
          AddSolid(kit.b, kit.UseColour(), book, -0.08F, 0.08F, 0, thick, -0.11F, 0.11F);
          top += thick;
        }
        break;
      }
      case 3:  // papers
        for (int k = 1 + kit.random.Int(3); k > 0; --k) {
          const Panel sheet = Turned(at, 0, 0, kit.Draw(-0.4, 0.4), 0.002F * static_cast<float>(k));
          AddSolid(kit.b, kit.UseGrey(kit.Draw(0.75, 0.95)), sheet, -0.105F, 0.105F, 0, 0.002F,
                   -0.15F, 0.15F);
        }
        break;
      case 4: {
        const float half = kit.Draw(0.04, 0.1);
        AddSolid(kit.b, kit.UseColour(), at, -half, half, 0, kit.Draw(0.03, 0.2), -0.06F, 0.06F);
        break;
      }
      default: {  // a bowl with fruit
        const float radius = kit.Draw(0.06, 0.12);
        kit.b.AddTube(kit.UseColour(), at.origin, at.At(0, 0.06F), 0.5F * radius, radius, 16);
        for (int k = 0; k < 3; ++k) {
          const float r = kit.Draw(0.025, 0.04);
          kit.b.AddEllipsoid(
              kit.UseColour(),
              at.At(kit.Draw(-0.4, 0.4) * radius, 0.05F, kit.Draw(-0.4, 0.4) * radius), {r, r, r});
        }
      }
    }
  }
}

void AddTable(Kit& kit, const Panel& p, float width, float depth, float height) {
  const bool is_round_legged = kit.random.Chance(0.3);
  const float thick = kit.Draw(0.02, 0.05);
  const Coat legs = kit.random.Chance(0.3) ? kit.metal : kit.wood;
  const float side = kit.Draw(0.035, 0.075);
  if (is_round_legged) {
    const MaterialId leg = kit.Use(legs);
    for (const float x : {0.07F, width - 0.07F}) {
      for (const float d : {0.07F, depth - 0.07F})
        kit.b.AddTube(leg, p.At(x, 0, d), p.At(x, height - thick, d), 0.35F * side, 0.6F * side,
                      10);
    }
  } else {
    AddLegs(kit, legs, p, 0.03F, width - 0.03F, 0.03F, depth - 0.03F, height - thick, side);
    const MaterialId apron = kit.Use(legs);
    AddSolid(kit.b, apron, p, 0.05F, width - 0.05F, height - thick - 0.08F, height - thick, 0.05F,
             0.07F);
    AddSolid(kit.b, apron, p, 0.05F, width - 0.05F, height - thick - 0.08F, height - thick,
             depth - 0.07F, depth - 0.05F);
  }
  AddSolid(kit.b, kit.Use(kit.wood), p, 0, width, height - thick, height, 0, depth);
  if (kit.random.Chance(0.15)) {  // a tablecloth
    kit.b.set_tint({1, 1, 1, 1});
    AddSolid(kit.b, kit.Pick(kit.m.cloths), p, -0.01F, width + 0.01F, height - 0.22F,
             height + 0.004F, -0.01F, depth + 0.01F);
  }
  AddClutter(kit, p, 0.05F, width - 0.05F, 0.05F, depth - 0.05F, height + 0.004F,
             kit.random.Int(7));
}

void AddDesk(Kit& kit, const Panel& p, float width, float depth) {
  const float height = kit.Draw(0.7, 0.76);
  AddLegs(kit, kit.metal, p, 0.03F, width - 0.03F, 0.03F, depth - 0.03F, height - 0.03F, 0.05F);
  AddSolid(kit.b, kit.Use(kit.wood), p, 0, width, height - 0.03F, height, 0, depth);
  if (kit.random.Chance(0.6))
    AddSolid(kit.b, kit.Use(kit.second), p, 0.06F, width - 0.06F, 0.25F, height - 0.03F, 0.02F,
             0.04F);
  if (kit.random.Chance(0.6)) {  // a pedestal with drawers
    const float x = kit.random.Chance(0.5) ? 0.06F : width - 0.48F;
    AddSolid(kit.b, kit.Use(kit.second), p, x, x + 0.42F, 0.04F, 0.6F, 0.06F, depth - 0.08F);
    for (int i = 0; i < 3; ++i)
      AddSolid(kit.b, kit.Use(kit.second), p, x + 0.01F, x + 0.41F,
               0.06F + 0.18F * static_cast<float>(i), 0.22F + 0.18F * static_cast<float>(i),
               depth - 0.08F, depth - 0.065F);
  }
  const int screens = 1 + kit.random.Int(2);
  for (int i = 0; i < screens; ++i) {
    const float x = width * (static_cast<float>(i) + 0.5F) / static_cast<float>(screens) +
                    kit.Draw(-0.08, 0.08);
    const float away = kit.Draw(0.14, 0.25);
    const Panel screen = Turned(p, x, away, kit.Draw(-0.25, 0.25), height);
    const MaterialId dark = kit.UseGrey(0.025F);
    const float half = kit.Draw(0.2, 0.32);
    AddSolid(kit.b, dark, screen, -0.11F, 0.11F, 0, 0.012F, -0.08F, 0.1F);
    AddSolid(kit.b, dark, screen, -0.02F, 0.02F, 0.01F, 0.25F, -0.03F, 0);
    AddSolid(kit.b, dark, screen, -half, half, 0.12F, 0.12F + 1.15F * half, 0, 0.025F);
    kit.b.set_tint({1, 1, 1, 1});
    const MaterialId image = kit.random.Chance(0.7) ? kit.Pick(kit.m.screens) : kit.UseGrey(0.015F);
    kit.b.AddImage(image, screen, -half + 0.01F, half - 0.01F, 0.13F, 0.11F + 1.15F * half,
                   0.0265F);
  }
  const float x = 0.5F * width + kit.Draw(-0.1, 0.1);
  const MaterialId keys = kit.UseGrey(kit.random.Chance(0.6) ? 0.03F : 0.5F);
  AddSolid(kit.b, keys, p, x - 0.22F, x + 0.22F, height, height + 0.02F, depth - 0.28F,
           depth - 0.14F);
  AddSolid(kit.b, keys, p, x + 0.3F, x + 0.36F, height, height + 0.03F, depth - 0.26F,
           depth - 0.15F);
  AddClutter(kit, p, 0.03F, width - 0.03F, 0.05F, depth - 0.05F, height, 1 + kit.random.Int(7));
}

}  // namespace orb360::town
