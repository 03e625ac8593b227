#include "apps/town/world/interior/outside.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "apps/town/world/building.h"
#include "apps/town/world/tree.h"

namespace orb360::town {

void AddOutside(const FloorPlan& plan, const Materials& materials, const Random& random,
                Scenery* scenery) {
  Random draw = random.Fork(1);
  Area bounds = plan.rooms[0].area;
  for (const Room& room : plan.rooms) {
    bounds = {std::min(bounds.x0, room.area.x0), std::max(bounds.x1, room.area.x1),
              std::min(bounds.y0, room.area.y0), std::max(bounds.y1, room.area.y1)};
  }
  const bool is_low = plan.kind == BuildingKind::kCellar || plan.kind == BuildingKind::kGarage ||
                      plan.kind == BuildingKind::kHall;
  const auto below = static_cast<float>(is_low || draw.Chance(0.4) ? 0.5 : draw.Uniform(2.5, 9));
  MeshBuilder builder(materials);
  const Vector3f middle(bounds.Centre().x(), bounds.Centre().y(), -below);
  constexpr float kReach = 250;  // metres
  builder.AddGroundPolygon(
      draw.Chance(0.5) ? materials.grass : materials.asphalt,
      {middle + Vector3f(-kReach, -kReach, 0), middle + Vector3f(kReach, -kReach, 0),
       middle + Vector3f(kReach, kReach, 0), middle + Vector3f(-kReach, kReach, 0)});
  std::vector<Instance> trees;
  for (uint32_t i = 0; i < 2; ++i)
    scenery->models.push_back(MakeTree(materials, random.Fork(10 + i)));
  for (int side = 0; side < 4; ++side) {
    const Vector3f out = side % 2 == 0 ? Vector3f(0, side == 0 ? 1.0F : -1.0F, 0)
                                       : Vector3f(side == 1 ? 1.0F : -1.0F, 0, 0);
    const Vector3f right = out.cross(Vector3f::UnitZ());
    const float half = 0.5F * (side % 2 == 0 ? bounds.depth() : bounds.width());
    const float span = 0.5F * (side % 2 == 0 ? bounds.width() : bounds.depth()) + 18;
    const auto away = static_cast<float>(draw.Uniform(9, 28));
    for (float x = -span; x < span;) {
      const auto width = static_cast<float>(draw.Uniform(8, 15));
      Random house = random.Fork(100 + static_cast<uint64_t>(draw.Int(1000000)));
      if (draw.Chance(0.8))
        AddBuilding({middle + (half + away) * out + x * right, right, width, 10, 0}, house,
                    builder);
      if (draw.Chance(0.35)) {
        Instance tree;
        tree.model = static_cast<uint32_t>(draw.Int(2));
        tree.world_from_model.translate(
            middle + (half + static_cast<float>(draw.Uniform(5, 8))) * out + x * right);
        tree.world_from_model.rotate(
            Eigen::AngleAxisf(static_cast<float>(draw.Uniform(0, 6.28)), Vector3f::UnitZ()));
        trees.push_back(tree);
      }
      x += width + static_cast<float>(draw.Chance(0.2) ? draw.Uniform(2, 8) : 0);
    }
  }
  scenery->models.push_back(std::move(builder.mesh()));
  Instance houses;
  houses.model = static_cast<uint32_t>(scenery->models.size() - 1);
  houses.lookout = 60;  // above the roofs
  scenery->instances.push_back(houses);
  for (Instance& tree : trees) {
    tree.lookout = 12;
    scenery->instances.push_back(tree);
  }
}

}  // namespace orb360::town
