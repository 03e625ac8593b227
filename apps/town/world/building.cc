#include "apps/town/world/building.h"

#include <array>
#include <cmath>

#include "apps/town/world/facade.h"

namespace orb360::town {
namespace {

void AddRoof(MeshBuilder& b, const FacadeStyle& style, const Lot& lot, const Vector3f& back,
             Random& random) {
  const Materials& m = b.materials();
  const float eaves = EavesHeight(style) + 0.08F;
  const Vector3f up(0, 0, 1);
  const auto at = [&](float x, float y, float z) -> Vector3f {
    return lot.front_left + x * lot.right + y * back + (eaves + z) * up;
  };
  const float w = lot.width;
  const float d = lot.depth;
  if (style.pitched_roof) {
    const float rise = d * static_cast<float>(random.Uniform(0.22, 0.42));
    constexpr float kOverhang = 0.4F;
    const float fall = kOverhang * rise / (0.5F * d);
    const float shade = static_cast<float>(random.Uniform(0.6, 1.0));
    b.set_tint({shade, shade * static_cast<float>(random.Uniform(0.75, 1)),
                shade * static_cast<float>(random.Uniform(0.7, 1)), 1});
    b.AddFace(m.roof_tiles, at(0, -kOverhang, -fall), at(w, -kOverhang, -fall),
              at(w, 0.5F * d, rise), at(0, 0.5F * d, rise));
    b.AddFace(m.roof_tiles, at(w, d + kOverhang, -fall), at(0, d + kOverhang, -fall),
              at(0, 0.5F * d, rise), at(w, 0.5F * d, rise));
    b.set_tint(style.wall_tint);
    b.AddFace(style.wall, at(0, d, 0), at(0, 0, 0), at(0, 0.5F * d, rise), at(0, 0.5F * d, rise));
    b.AddFace(style.wall, at(w, 0, 0), at(w, d, 0), at(w, 0.5F * d, rise), at(w, 0.5F * d, rise));
  } else {
    constexpr float kParapet = 0.6F;
    b.set_tint({1, 1, 1, 1});
    b.AddFace(m.gravel, at(0, 0, 0), at(w, 0, 0), at(w, d, 0), at(0, d, 0));
    b.set_tint(style.wall_tint);
    const std::array<Panel, 4> sides = {{{at(0, 0, 0), lot.right, up, -back},
                                         {at(w, 0, 0), back, up, lot.right},
                                         {at(w, d, 0), -lot.right, up, back},
                                         {at(0, d, 0), -back, up, -lot.right}}};
    for (size_t i = 0; i < 4; ++i) {
      const float length = i % 2 == 0 ? w : d;
      b.AddBox(style.wall, sides[i], 0, length, 0, kParapet, -0.3F, 0);
      b.AddFace(style.wall, sides[i].At(length, 0, -0.3F), sides[i].At(0, 0, -0.3F),
                sides[i].At(0, kParapet, -0.3F), sides[i].At(length, kParapet, -0.3F));
    }
  }
  const int chimneys = 1 + random.Int(3);
  for (int i = 0; i < chimneys; ++i) {
    const auto x = static_cast<float>(random.Uniform(0.1, 0.85)) * w;
    const auto y = static_cast<float>(random.Uniform(0.3, 0.6)) * d;
    const float top = style.pitched_roof ? 0.42F * d + 0.8F : 2.2F;
    const Panel front{at(x, y, 0), lot.right, up, -back};
    b.set_tint({0.9F, 0.9F, 0.9F, 1});
    b.AddBox(m.bricks.front(), front, 0, 0.9F, 0, top, -0.6F, 0);
    b.AddFace(m.bricks.front(), front.At(0.9F, 0, -0.6F), front.At(0, 0, -0.6F),
              front.At(0, top, -0.6F), front.At(0.9F, top, -0.6F));
  }
}

}  // namespace

void AddBuilding(const Lot& lot, Random& random, MeshBuilder& builder) {
  const FacadeStyle style = DrawFacadeStyle(random, builder.materials(), lot.width);
  const Vector3f up(0, 0, 1);
  const Vector3f back = up.cross(lot.right);  // away from the street
  const Vector3f front_right = lot.front_left + lot.width * lot.right;
  const Vector3f back_right = front_right + lot.depth * back;
  const Vector3f back_left = lot.front_left + lot.depth * back;
  AddFacade(builder, style, {lot.front_left, lot.right, up, -back}, lot.width, lot.ground_drop,
            true, true, random);
  AddFacade(builder, style, {front_right, back, up, lot.right}, lot.depth, lot.ground_drop, false,
            random.Chance(0.4), random);
  AddBack(builder, style, {back_right, -lot.right, up, back}, lot.width, lot.ground_drop, random);
  AddFacade(builder, style, {back_left, -back, up, -lot.right}, lot.depth, lot.ground_drop, false,
            random.Chance(0.4), random);
  AddRoof(builder, style, lot, back, random);
  builder.set_texture_origin(Vector2f::Zero());
}

}  // namespace orb360::town
