#include "apps/town/world/landmarks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "apps/town/world/ground.h"

namespace orb360::town {

void AddParkPaths(const StreetPlan& plan, const Park& park, MeshBuilder& builder) {
  constexpr double kPiece = 1.0;  // metres
  // The height is millimetres above the lawn, so that the path lies above the triangles of a slope.
  const auto lift = [&](const Vector2d& p, double above) -> Vector3f {
    return Eigen::Vector3d(p.x(), p.y(), plan.Height(p) + kKerbHeight + above).cast<float>();
  };
  const MaterialId gravel = builder.materials().gravel;
  builder.set_tint({1, 0.93F, 0.82F, 1});
  for (const Vector2d& gate : park.gates) {
    const Vector2d along = (gate - park.centre).normalized();
    const Vector2d left = kPathHalfWidth * Vector2d(-along.y(), along.x());
    const int pieces = static_cast<int>((gate - park.centre).norm() / kPiece);
    for (int i = 0; i < pieces; ++i) {
      const Vector2d a = park.centre + (kParkCircle - 0.4 + kPiece * i) * along;
      const Vector2d b = a + kPiece * along;
      if (plan.DistanceToRoad(b) < plan.PavementAt(b) - 0.3) break;
      builder.AddGroundPolygon(
          gravel, {lift(a - left, 0), lift(b - left, 0), lift(b + left, 0), lift(a + left, 0)});
    }
  }
  constexpr int kRings = 4;
  constexpr int kSides = 28;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kSides; ++i) {
      const auto corner = [&](int r, int k) {
        const double angle = 2 * std::numbers::pi * k / kSides;
        return lift(
            park.centre + kParkCircle * r / kRings * Vector2d(std::cos(angle), std::sin(angle)),
            0.004);
      };
      builder.AddGroundPolygon(gravel, {corner(ring, i), corner(ring + 1, i),
                                        corner(ring + 1, i + 1), corner(ring, i + 1)});
    }
  }
  builder.set_tint({1, 1, 1, 1});
}

void AddBridge(const StreetPlan& plan, const Bridge& bridge, MeshBuilder& builder) {
  constexpr float kClearance = 4.4F;  // metres above the highest point of the street
  constexpr float kGirder = 0.9F;     // metres high
  constexpr float kParapet = 1.1F;
  constexpr float kBelowGround = 2;
  const Materials& m = builder.materials();
  const Vector2d across(-bridge.along.y(), bridge.along.x());
  double highest = -1e30;
  double lowest = 1e30;
  for (const double end : {-1.0, 0.0, 1.0}) {
    for (const double side : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const Vector2d p =
          bridge.centre + end * bridge.half_width * bridge.along + side * bridge.reach * across;
      highest = std::max(highest, plan.Height(p));
      lowest = std::min(lowest, plan.Height(p));
    }
  }
  const auto base = static_cast<float>(lowest);
  const float deck = static_cast<float>(highest) + kClearance - base;
  const auto w = static_cast<float>(bridge.half_width);
  const auto opening = static_cast<float>(bridge.half_opening);
  const auto reach = static_cast<float>(bridge.reach);
  const Vector3f centre(static_cast<float>(bridge.centre.x()),
                        static_cast<float>(bridge.centre.y()), base);
  const Vector3f along(static_cast<float>(bridge.along.x()), static_cast<float>(bridge.along.y()),
                       0);
  const Vector3f left(static_cast<float>(across.x()), static_cast<float>(across.y()), 0);
  const Vector3f up = Vector3f::UnitZ();
  const MaterialId brick = m.bricks[2];
  for (const float side : {1.0F, -1.0F}) {
    // The walls are solid. Seen from the street their right is along it or against it.
    const Panel wall{centre + side * opening * left, side * along, up, -side * left};
    builder.set_tint({0.8F, 0.78F, 0.75F, 1});
    builder.AddBox(brick, wall, -w, w, -kBelowGround, deck + kGirder, -(reach - opening), 0);
    const Panel end{centre + side * reach * left, -side * along, up, side * left};
    builder.AddRectangle(brick, end, -w, w, -kBelowGround, deck + kGirder);
    // Stone blocks under the girders.
    builder.set_tint({1, 1, 1, 1});
    builder.AddBox(m.ashlar, wall, -w - 0.08F, w + 0.08F, deck - 0.45F, deck, -0.5F, 0.12F);
    // A girder on this side of the bridge, and the parapet along all of it.
    const Panel front{centre + side * w * along, side * left, up, side * along};
    builder.set_tint({0.2F, 0.27F, 0.23F, 1});
    builder.AddBox(m.metal, front, -opening, opening, deck, deck + kGirder, -0.35F, 0.06F);
    constexpr float kRib = 1.5F;  // metres between stiffeners
    const int ribs = static_cast<int>(2 * opening / kRib);
    for (int i = 0; i < ribs; ++i) {
      const float x = -opening + (static_cast<float>(i) + 0.5F) * kRib;
      builder.AddBox(m.metal, front, x - 0.05F, x + 0.05F, deck, deck + kGirder, 0, 0.16F);
    }
    builder.set_tint({1, 1, 1, 1});
    builder.AddBox(m.ashlar, front, -reach, reach, deck + kGirder, deck + kGirder + 0.25F, -0.5F,
                   0.2F);
    builder.set_tint({0.8F, 0.78F, 0.75F, 1});
    builder.AddBox(brick, front, -reach, reach, deck + kGirder + 0.25F, deck + kGirder + kParapet,
                   -0.35F, 0.05F);
    const Panel inside{front.At(0, 0, -0.35F), -front.right, up, -front.out};
    builder.AddRectangle(brick, inside, -reach, reach, deck, deck + kGirder + kParapet);
  }
  // The deck: its underside and the ballast on it.
  const auto corner = [&](float x, float y, float z) -> Vector3f {
    return centre + x * along + y * left + z * up;
  };
  builder.set_tint({0.45F, 0.45F, 0.44F, 1});
  builder.AddFace(m.concrete, corner(-w, opening, deck + 0.3F), corner(w, opening, deck + 0.3F),
                  corner(w, -opening, deck + 0.3F), corner(-w, -opening, deck + 0.3F));
  constexpr float kBeams = 1.6F;  // metres between beams
  for (int i = 0; i < static_cast<int>((2 * w - 1) / kBeams); ++i) {
    const float x = -w + 1 + kBeams * static_cast<float>(i);
    const Panel beam{corner(x, 0, deck), left, up, along};
    builder.AddBox(m.metal, beam, -opening, opening, 0, 0.3F, -0.2F, 0.0F);
  }
  builder.set_tint({0.6F, 0.58F, 0.55F, 1});
  builder.AddGroundPolygon(m.gravel,
                           {corner(-w, -reach, deck + kGirder), corner(w, -reach, deck + kGirder),
                            corner(w, reach, deck + kGirder), corner(-w, reach, deck + kGirder)});
  builder.set_tint({1, 1, 1, 1});
}

}  // namespace orb360::town
