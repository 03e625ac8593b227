#include "apps/town/world/building.h"

#include "apps/town/world/facade.h"
#include "apps/town/world/roof.h"

namespace orb360::town {

void AddBuilding(const Lot& lot, Random& random, MeshBuilder& builder) {
  const FacadeStyle style = DrawFacadeStyle(random, builder.materials(), lot.width);
  const Vector3f up(0, 0, 1);
  const Vector3f back = up.cross(lot.right);  // away from the street
  const Vector3f front_right = lot.front_left + lot.width * lot.right;
  const Vector3f back_right = front_right + lot.depth * back;
  const Vector3f back_left = lot.front_left + lot.depth * back;
  constexpr double kWindowsAside = 0.5;  // fraction of the sides that have them
  AddFront(builder, style, {lot.front_left, lot.right, up, -back}, lot.width, lot.ground_drop,
           random);
  AddSide(builder, style, {front_right, back, up, lot.right}, lot.depth, lot.ground_drop,
          random.Chance(kWindowsAside), random);
  AddBack(builder, style, {back_right, -lot.right, up, back}, lot.width, lot.ground_drop, random);
  AddSide(builder, style, {back_left, -back, up, -lot.right}, lot.depth, lot.ground_drop,
          random.Chance(kWindowsAside), random);
  AddRoof(builder, style, lot, random);
  builder.set_texture_origin(Vector2f::Zero());
}

}  // namespace orb360::town
