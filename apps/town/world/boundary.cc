#include "apps/town/world/boundary.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "apps/town/world/hedge.h"

namespace orb360::town {
namespace {

/// Adds a wall with a coping, `length` along the panel, visible from both sides.
void AddGardenWall(MeshBuilder& b, const Panel& p, float length, float height, Random& random) {
  const Materials& m = b.materials();
  constexpr float kThickness = 0.24F;  // metres
  const bool brick = random.Chance(0.6);
  const MaterialId material =
      brick ? random.Pick(std::span<const MaterialId>(m.bricks)) : m.plaster;
  const auto shade = static_cast<float>(random.Uniform(0.6, 0.95));
  const auto add = [&](MaterialId id, float low, float high, float overhang) {
    b.AddBox(id, p, 0, length, low, high, -kThickness - overhang, overhang);
    const Panel rear{p.At(length, 0, -kThickness - overhang), -p.right, p.up, -p.out};
    b.AddRectangle(id, rear, 0, length, low, high);
  };
  b.set_tint({shade, shade * 0.97F, shade * 0.92F, 1});
  add(material, -1.0F, height, 0);
  b.set_tint({0.7F, 0.69F, 0.66F, 1});
  add(m.concrete, height, height + 0.08F, 0.05F);
}

}  // namespace

void AddBoundaries(const std::vector<Lot>& lots, const Random& random, MeshBuilder& b) {
  constexpr float kNarrowest = 0.8F;  // metres of gap
  constexpr float kWidest = 9.0F;
  for (size_t i = 0; i < lots.size(); ++i) {
    const Lot& left = lots[i];
    const Vector3f from = left.front_left + left.width * left.right;
    for (const Lot& right : lots) {
      const Vector3f gap = right.front_left - from;
      const float length = gap.head<2>().norm();
      if (length < kNarrowest || length > kWidest || gap.dot(left.right) < 0.9F * length ||
          left.right.dot(right.right) < 0.9F)
        continue;
      Random own = random.Fork(i);
      const Vector3f along = Vector3f(gap.x(), gap.y(), 0).normalized();
      const float base = std::min(left.front_left.z() - left.ground_drop,
                                  right.front_left.z() - right.ground_drop);
      const float top = std::max(left.front_left.z(), right.front_left.z());
      const Panel panel{Vector3f(from.x(), from.y(), base), along, Vector3f::UnitZ(),
                        Vector3f(along.y(), -along.x(), 0)};
      const float rise = top - base;
      const double kind = own.Uniform();
      if (kind < 0.4) {
        AddGardenWall(b, panel, length, rise + static_cast<float>(own.Uniform(1.1, 2.3)), own);
      } else if (kind < 0.75) {
        AddHedge(b, panel, length, rise + static_cast<float>(own.Uniform(1.0, 1.9)), 0.9F, own);
      } else {
        AddGardenWall(b, panel, length, rise + 0.4F, own);
        b.set_tint({1, 1, 1, 1});
        b.AddRectangle(b.materials().railing, panel, 0, length, rise + 0.48F, rise + 1.48F, -0.12F);
      }
    }
  }
}

}  // namespace orb360::town
