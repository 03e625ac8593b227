#include "apps/town/world/shop_front.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "apps/town/world/opening.h"

namespace orb360::town {
namespace {

constexpr float kReveal = 0.25F;  // metres from the wall to the shop's frame
constexpr float kPaneDepth = 0.03F;

MaterialId PickFrom(Random& random, const std::vector<MaterialId>& values) {
  return random.Pick(std::span<const MaterialId>(values));
}

Rgba DrawShopPaint(Random& random) {
  static constexpr std::array<std::array<int, 3>, 12> kColours = {{{32, 44, 40},
                                                                   {24, 36, 58},
                                                                   {92, 26, 30},
                                                                   {40, 40, 42},
                                                                   {176, 168, 150},
                                                                   {70, 86, 74},
                                                                   {120, 92, 60},
                                                                   {30, 74, 84},
                                                                   {150, 60, 40},
                                                                   {200, 196, 186},
                                                                   {86, 60, 82},
                                                                   {60, 42, 30}}};
  const auto& c = kColours[static_cast<size_t>(random.Int(12))];
  return static_cast<float>(random.Uniform(0.8, 1.2)) * Srgb(c[0], c[1], c[2]);
}

void AddAwning(MeshBuilder& b, const Panel& p, float x0, float x1, float z, Random& random) {
  const MaterialId cloth = b.materials().trim;
  static constexpr std::array<std::array<int, 3>, 6> kCloths = {
      {{120, 34, 34}, {36, 66, 52}, {40, 56, 96}, {176, 132, 60}, {90, 88, 84}, {150, 80, 50}}};
  const auto& c = kCloths[static_cast<size_t>(random.Int(6))];
  const Rgba main = Srgb(c[0], c[1], c[2]);
  const Rgba other = random.Chance(0.6) ? Rgba{0.66F, 0.63F, 0.56F, 1} : main;
  const auto reach = static_cast<float>(random.Uniform(0.9, 1.5));
  const float drop = 0.35F * reach;
  constexpr float kStripe = 0.3F;    // metres
  constexpr float kValance = 0.22F;  // metres
  const int stripes = std::max(1, static_cast<int>((x1 - x0) / kStripe));
  for (int i = 0; i < stripes; ++i) {
    const float a = std::lerp(x0, x1, static_cast<float>(i) / static_cast<float>(stripes));
    const float e = std::lerp(x0, x1, static_cast<float>(i + 1) / static_cast<float>(stripes));
    b.set_tint(i % 2 == 0 ? main : other);
    b.AddFace(cloth, p.At(a, z - drop, reach), p.At(e, z - drop, reach), p.At(e, z, 0.1F),
              p.At(a, z, 0.1F));
    b.AddFace(cloth, p.At(a, z - 0.02F, 0.1F), p.At(e, z - 0.02F, 0.1F),
              p.At(e, z - drop - 0.02F, reach), p.At(a, z - drop - 0.02F, reach));
    // The valance ends in a scallop.
    const float middle = 0.5F * (a + e);
    b.AddFace(cloth, p.At(a, z - drop - 0.7F * kValance, reach),
              p.At(middle, z - drop - kValance, reach), p.At(middle, z - drop, reach),
              p.At(a, z - drop, reach));
    b.AddFace(cloth, p.At(middle, z - drop - kValance, reach),
              p.At(e, z - drop - 0.7F * kValance, reach), p.At(e, z - drop, reach),
              p.At(middle, z - drop, reach));
  }
}

/// Adds a sign that hangs over the pavement, with text on both sides.
void AddHangingSign(MeshBuilder& b, const Panel& p, float x, float z, MaterialId sign) {
  const Materials& m = b.materials();
  b.set_tint({0.03F, 0.03F, 0.03F, 1});
  b.AddTube(m.metal, p.At(x, z + 0.12F, 0), p.At(x, z + 0.12F, 1.0F), 0.018F, 0.018F, 5);
  b.set_tint({1, 1, 1, 1});
  const Panel left{p.At(x - 0.02F, z, 0.15F), p.out, p.up, -p.right};
  const Panel right{p.At(x + 0.02F, z, 0.95F), -p.out, p.up, p.right};
  b.AddImage(sign, left, 0, 0.8F, -0.14F, 0.08F);
  b.AddImage(sign, right, 0, 0.8F, -0.14F, 0.08F);
}

}  // namespace

void AddShopFront(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float left, float right,
                  float drop, Random& random) {
  const Materials& m = b.materials();
  const float height = style.ground_height;
  const float sign_bottom = height - 0.95F;
  const float x0 = left + 0.3F;
  const float x1 = right - 0.3F;
  const auto z0 = static_cast<float>(random.Uniform(0.25, 0.65));
  const float z1 = sign_bottom - 0.1F;
  AddWallWithOpening(b, style.ground_wall, style.ground_tint, p, {left, right, 0, height},
                     {x0, x1, 0.02F, z1}, kReveal, 0.8F);
  const float door = x0 + (x1 - x0) * (random.Chance(0.5) ? 0.0F : 0.72F);
  const float door_end = door + std::min(1.1F, 0.28F * (x1 - x0));
  const Rgba paint = DrawShopPaint(random);
  const bool closed = random.Chance(0.1);
  const auto glaze = [&](float a, float c) {
    if (c - a < 0.4F) return;
    b.set_tint(paint);
    b.AddBox(m.trim, p, a, c, 0.02F, z0, -kReveal - kPaneDepth, -kReveal + 0.05F);
    const int panes = std::max(1, static_cast<int>((c - a) / 1.9F));
    for (int i = 0; i < panes; ++i) {
      const auto edge = [&](int k) {
        return std::lerp(a, c, static_cast<float>(k) / static_cast<float>(panes));
      };
      AddWindow(b, paint, p, {edge(i), edge(i + 1), z0, z1}, kReveal, random.Chance(0.15),
                PickFrom(random, m.shops), random);
      if (closed || !random.Chance(0.12)) continue;
      b.set_tint({1, 1, 1, 1});  // a bill stuck to the pane
      const auto x = static_cast<float>(random.Uniform(edge(i) + 0.1, edge(i + 1) - 0.6));
      b.AddImage(PickFrom(random, m.posters), p, x, x + 0.4F, z0 + 0.3F, z0 + 1.1F,
                 -kReveal - 0.5F * kPaneDepth);
    }
  };
  glaze(x0, door);
  glaze(door_end, x1);
  const float lintel = std::min(z1, 2.3F);
  b.set_tint({1, 1, 1, 1});
  b.AddImage(PickFrom(random, m.doors), p, door, door_end, 0.02F, lintel, -kReveal);
  if (z1 > lintel)
    AddPane(b, PickFrom(random, m.rooms), p, {door, door_end, lintel, z1}, -kReveal, random);
  if (closed) {
    b.set_tint({1, 1, 1, 1});
    const int parts = std::max(1, static_cast<int>((x1 - x0) / 3.0F));
    for (int i = 0; i < parts; ++i) {
      const auto edge = [&](int k) {
        return std::lerp(x0, x1, static_cast<float>(k) / static_cast<float>(parts));
      };
      b.AddImage(PickFrom(random, m.roller_shutters), p, edge(i), edge(i + 1), 0.02F, z1,
                 -0.5F * kReveal);
    }
  }
  b.set_tint({0.8F, 0.79F, 0.77F, 1});
  AddSteps(b, p, door - 0.1F, door_end + 0.1F, 0.02F, drop);
  b.set_tint(paint);
  b.AddBox(m.trim, p, left + 0.15F, right - 0.15F, sign_bottom - 0.08F, height - 0.12F, 0, 0.1F);
  b.AddBox(m.trim, p, left + 0.1F, right - 0.1F, height - 0.16F, height - 0.06F, 0, 0.18F);
  b.AddBox(m.trim, p, left + 0.08F, left + 0.3F, 0, height - 0.12F, 0, 0.07F);
  b.AddBox(m.trim, p, right - 0.3F, right - 0.08F, 0, height - 0.12F, 0, 0.07F);
  b.set_tint({1, 1, 1, 1});
  constexpr float kSign = 0.62F;  // metres
  const float sign_width = std::min(right - left - 0.5F, 4 * kSign);
  const float middle = 0.5F * (left + right);
  const MaterialId sign = PickFrom(random, m.signs);
  b.AddImage(sign, p, middle - 0.5F * sign_width, middle + 0.5F * sign_width, sign_bottom,
             sign_bottom + kSign, 0.115F);
  if (random.Chance(0.3)) AddHangingSign(b, p, right - 0.2F, sign_bottom - 0.1F, sign);
  if (!closed && random.Chance(0.45)) AddAwning(b, p, x0, x1, z1 - 0.02F, random);
}

}  // namespace orb360::town
