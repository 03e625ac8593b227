#include <cmath>
#include <numbers>

#include "apps/town/world/interior/furniture.h"

namespace orb360::town {

void AddChair(Kit& kit, const Panel& p) {
  const bool is_steel = kit.random.Chance(0.35);
  const Coat frame = is_steel ? kit.metal : kit.second;
  const float side = is_steel ? 0.022F : 0.036F;
  const float seat = kit.Draw(0.43, 0.47);
  const float top = kit.Draw(0.8, 1);
  AddLegs(kit, frame, p, 0.01F, 0.44F, 0.01F, 0.43F, seat, side);
  const bool is_padded = kit.random.Chance(0.4);
  const MaterialId seat_material = kit.Use(is_padded ? kit.cloth : kit.second);
  if (is_padded)
    AddCushion(kit.b, seat_material, p, 0, 0.45F, seat - 0.02F, seat + 0.05F, 0, 0.45F);
  else
    AddSolid(kit.b, seat_material, p, 0, 0.45F, seat, seat + 0.025F, 0, 0.45F);
  const MaterialId back = kit.Use(frame);
  for (const float x : {0.01F, 0.44F - side})
    kit.b.AddTube(back, p.At(x + 0.5F * side, seat, 0.03F), p.At(x + 0.5F * side, top, -0.03F),
                  0.6F * side, 0.5F * side, 8);
  kit.Use(is_padded ? kit.cloth : kit.second);
  const int slats = is_padded ? 1 : 1 + kit.random.Int(3);
  const float tall = (top - seat - 0.12F) / static_cast<float>(slats);
  for (int i = 0; i < slats; ++i) {
    const float z = seat + 0.12F + tall * static_cast<float>(i);
    AddSolid(kit.b, seat_material, p, 0.02F, 0.43F, z + 0.2F * tall, z + tall, -0.03F, 0.01F);
  }
}

void AddOfficeChair(Kit& kit, const Panel& p) {
  const Vector3f hub = p.At(0.27F, 0.12F, 0.28F);
  const MaterialId dark = kit.UseGrey(0.03F);
  for (int i = 0; i < 5; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * (static_cast<float>(i) + 0.3F) / 5;
    const Vector3f tip =
        hub + 0.27F * (std::cos(angle) * p.right + std::sin(angle) * p.out) - 0.05F * p.up;
    kit.b.AddTube(dark, hub, tip, 0.025F, 0.018F, 8);
    kit.b.AddEllipsoid(dark, tip - 0.035F * p.up, {0.03F, 0.03F, 0.03F});
  }
  const float seat = kit.Draw(0.42, 0.52);
  kit.b.AddTube(kit.UseGrey(0.3F), hub, p.At(0.27F, seat, 0.28F), 0.025F, 0.025F, 10);
  const MaterialId pad = kit.random.Chance(0.5) ? kit.UseGrey(0.035F) : kit.Use(kit.cloth);
  AddCushion(kit.b, pad, p, 0.03F, 0.52F, seat, seat + 0.09F, 0.06F, 0.54F);
  AddCushion(kit.b, pad, p, 0.05F, 0.5F, seat + 0.15F, seat + kit.Draw(0.5, 0.75), -0.01F, 0.08F);
  kit.b.AddTube(kit.UseGrey(0.03F), p.At(0.27F, seat, 0.1F), p.At(0.27F, seat + 0.3F, 0), 0.02F,
                0.02F, 8);
  if (!kit.random.Chance(0.6)) return;
  for (const float x : {0.0F, 0.51F})
    AddSolid(kit.b, kit.UseGrey(0.03F), p, x, x + 0.04F, seat + 0.18F, seat + 0.22F, 0.12F, 0.42F);
}

void AddSofa(Kit& kit, const Panel& p, float width, float depth) {
  const float arm = kit.Draw(0.1, 0.24);
  const float seat = kit.Draw(0.38, 0.46);
  const float back = kit.Draw(0.7, 0.95);
  const MaterialId cloth = kit.Use(kit.cloth);
  AddSolid(kit.b, cloth, p, 0.01F, width - 0.01F, 0.08F, seat - 0.12F, 0.02F, depth - 0.03F);
  AddCushion(kit.b, cloth, p, 0, width, 0.1F, back, 0, 0.24F);
  const float arm_top = kit.Draw(0.5, 0.66);
  AddCushion(kit.b, cloth, p, 0, arm, 0.09F, arm_top, 0.05F, depth);
  AddCushion(kit.b, cloth, p, width - arm, width, 0.09F, arm_top, 0.05F, depth);
  const float inner = width - 2 * arm;
  const int seats = std::max(1, static_cast<int>(std::lround(inner / 0.7F)));
  for (int i = 0; i < seats; ++i) {
    const float x0 = arm + inner * static_cast<float>(i) / static_cast<float>(seats);
    const float x1 = x0 + inner / static_cast<float>(seats);
    AddCushion(kit.b, cloth, p, x0, x1, seat - 0.16F, seat, 0.16F, depth + 0.01F);
    AddCushion(kit.b, cloth, p, x0, x1, seat - 0.03F, back - 0.02F, 0.14F, 0.33F);
  }
  for (int i = kit.random.Int(3); i > 0; --i) {
    const float x = kit.Draw(arm, width - arm - 0.42F);
    const float away = kit.Draw(0.3, 0.36);
    const Panel thrown = Turned(p, x, away, kit.Draw(-0.3, 0.3), seat);
    kit.b.set_tint({1, 1, 1, 1});
    AddCushion(kit.b, kit.Pick(kit.m.cloths), thrown, 0, 0.4F, 0, 0.38F, 0, 0.14F);
  }
  AddLegs(kit, kit.wood, p, 0.05F, width - 0.05F, 0.05F, depth - 0.05F, 0.09F, 0.05F);
}

void AddBed(Kit& kit, const Panel& p, float width, float depth) {
  const float top = kit.Draw(0.42, 0.6);
  const bool is_steel = kit.random.Chance(0.2);
  const Coat frame = is_steel ? kit.metal : kit.wood;
  AddSolid(kit.b, kit.Use(frame), p, 0, width, 0.1F, top - 0.2F, 0, depth);
  AddSolid(kit.b, kit.Use(frame), p, 0, width, 0.1F, kit.Draw(0.7, 1.15), 0, 0.05F);
  if (kit.random.Chance(0.4))
    AddSolid(kit.b, kit.Use(frame), p, 0, width, 0.1F, top + 0.05F, depth - 0.04F, depth);
  AddLegs(kit, frame, p, 0, width, 0, depth, 0.11F, 0.06F);
  kit.b.set_tint({0.8F, 0.79F, 0.76F, 1});
  AddCushion(kit.b, kit.m.cloths[0], p, 0.02F, width - 0.02F, top - 0.22F, top, 0.05F,
             depth - 0.04F);
  kit.b.set_tint({1, 1, 1, 1});
  const MaterialId quilt = kit.Pick(kit.m.cloths);
  const float begin = kit.Draw(0.45, 0.9);
  AddCushion(kit.b, quilt, p, -0.05F, width + 0.05F, top - 0.2F, top + kit.Draw(0.05, 0.12), begin,
             depth - 0.01F);
  if (kit.random.Chance(0.5)) {
    const float x = kit.Draw(0, 0.2);
    AddCushion(kit.b, quilt, Turned(p, x, begin - 0.05F, kit.Draw(-0.15, 0.15), top), 0.1F,
               width - 0.1F, -0.02F, 0.17F, 0, 0.35F);
  }
  const int pillows = width > 1.3F ? 2 : 1;
  for (int i = 0; i < pillows; ++i) {
    const float x =
        (width - 0.62F * static_cast<float>(pillows)) / 2 + 0.62F * static_cast<float>(i);
    kit.b.set_tint({0.85F, 0.84F, 0.8F, 1});
    const MaterialId pillow = kit.random.Chance(0.5) ? kit.m.plain : quilt;
    AddCushion(kit.b, pillow, Turned(p, x, 0.06F, kit.Draw(-0.08, 0.08), top - 0.02F), 0.01F, 0.6F,
               0, 0.15F, 0, 0.4F);
  }
}

void AddBench(Kit& kit, const Panel& p, float width, float depth) {
  AddLegs(kit, kit.metal, p, 0.05F, width - 0.05F, 0.03F, depth - 0.03F, 0.42F, 0.04F);
  const MaterialId wood = kit.Use(kit.wood);
  const float half = 0.5F * depth;
  AddSolid(kit.b, wood, p, 0, width, 0.42F, 0.46F, 0, half - 0.01F);
  AddSolid(kit.b, wood, p, 0, width, 0.42F, 0.46F, half + 0.01F, depth);
}

}  // namespace orb360::town
