#include "apps/town/world/interior/parked_cars.h"

#include <numbers>
#include <vector>

#include "apps/town/world/vehicle.h"

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

void ParkCars(Placement& placement) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  const Area& a = room.area;
  const double fullness = placement.Draw(0.2, 0.85);
  const float bay = placement.Draw(2.4, 2.7);
  const auto park = [&](float x, float y, bool north) {
    const VehicleKind kind = DrawVehicleKind(kit.random);
    const float length = VehicleLength(kind);
    const float width = VehicleWidth(kind);
    const bool backed_in = placement.Chance(0.4);
    const float from_wall = 0.5F * length + placement.Draw(0.3, 0.7);
    const Vector3f at(x + placement.Draw(-0.15, 0.15), north ? y - from_wall : y + from_wall, 0);
    Area area{at.x() - 0.5F * width - 0.12F, at.x() + 0.5F * width + 0.12F, at.y() - 0.5F * length,
              at.y() + 0.5F * length};
    if (!placement.IsFree(area.Grown(0.05F))) return;
    const Rgba paint = DrawPaint(kit.random);
    Mesh car = MakeVehicle(kind, kit.m);
    const auto tint = EncodeTint(paint);
    for (const Triangle& triangle : car.triangles) {
      if (triangle.material != kit.m.paint) continue;
      for (const uint32_t vertex : triangle.vertices) car.vertices[vertex].tint = tint;
    }
    const bool faces_north = north != backed_in;
    Eigen::Affine3f place = Eigen::Affine3f::Identity();
    place.translate(at);
    place.rotate(Eigen::AngleAxisf((faces_north ? 0.5F : -0.5F) * kPi + placement.Draw(-0.03, 0.03),
                                   Vector3f::UnitZ()));
    kit.b.mesh().Append(car, place);
    placement.Take(area);
  };
  // Rows along both walls and, in wide garages, back to back in the middle.
  struct Row {
    float y;
    bool north;
  };
  std::vector<Row> rows = {{a.y0, false}, {a.y1, true}};
  if (a.depth() > 21.5F) {
    const float middle = a.Centre().y();
    rows.insert(rows.end(), {{middle, false}, {middle, true}});
  }
  for (float x = a.x0 + 0.6F; x < a.x1 - 0.5F; x += bay) {
    for (const auto& [y, north] : rows) {
      const Panel ground{
          {x, north ? y - 5 : y, 0.004F}, Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ()};
      kit.b.set_tint({0.75F, 0.74F, 0.7F, 1});
      kit.b.AddRectangle(kit.m.road_paint, ground, -0.05F, 0.05F, 0.1F, 4.9F);
      if (x + bay < a.x1 && placement.Chance(fullness)) park(x + 0.5F * bay, y, north);
    }
  }
}

}  // namespace orb360::town
