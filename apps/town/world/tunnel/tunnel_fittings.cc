#include "apps/town/world/tunnel/tunnel_fittings.h"

#include <algorithm>
#include <array>

namespace orb360::town {
namespace {

constexpr float kPointSpacing = 0.25F;  // metres between points of a trail

size_t PointsFor(float metres) {
  return std::max<size_t>(1, static_cast<size_t>(metres / kPointSpacing + 0.5F));
}

/// Returns the frame at a point of the trail, on the floor.
TrailFrame StandingFrame(const FittingKit& kit, size_t point) {
  TrailFrame frame = FrameAt(kit.trail, point);
  frame.origin.z() = kit.floor(frame.origin.head<2>());
  return frame;
}

/// Adds a straight beam between two places; its sides are `width` metres along `side` and `depth`
/// metres across it.
void AddBeam(MaterialId material, const Vector3f& from, const Vector3f& to, const Vector3f& side,
             float width, float depth, MeshBuilder& b) {
  const Vector3f along = (to - from).normalized();
  const Vector3f u = 0.5F * width * (side - side.dot(along) * along).normalized();
  const Vector3f v = 0.5F * depth * along.cross(u).normalized();
  const std::array<Vector3f, 4> corners = {Vector3f(u + v), Vector3f(v - u), Vector3f(-u - v),
                                           Vector3f(u - v)};
  for (size_t i = 0; i < 4; ++i) {
    const Vector3f& p = corners[i];
    const Vector3f& q = corners[(i + 1) % 4];
    b.AddFace(material, from + p, from + q, to + q, to + p);
  }
  b.AddFace(material, from + corners[3], from + corners[2], from + corners[1], from + corners[0]);
  b.AddFace(material, to + corners[0], to + corners[1], to + corners[2], to + corners[3]);
}

}  // namespace

void AddLampRow(const LampRow& row, FittingKit& kit) {
  const float warm = kit.Draw(0, 1);
  const Vector3f colour(1, 0.98F - 0.22F * warm, 1 - 0.5F * warm);
  // About half of the light of a lamp reaches the floor.
  const float radiance =
      row.brightness * row.spacing * row.lit_width / (0.55F * row.size.x() * row.size.y());
  const size_t every = PointsFor(row.spacing);
  for (size_t i = 0; i < kit.trail.points().size(); i += every) {
    const TrailFrame frame = StandingFrame(kit, i);
    const bool is_lit = !kit.random.Chance(row.broken);
    const Vector2f half = 0.5F * row.size;
    const auto corner = [&](float x, float forward) {
      return frame.At(row.x + x, row.height, forward);
    };
    kit.b.set_tint(is_lit ? Rgba{colour.x(), colour.y(), colour.z(), 1}
                          : Rgba{0.5F, 0.5F, 0.5F, 1});
    const Vector3f a = corner(-half.y(), -half.x());
    const Vector3f forward = row.size.x() * frame.along;
    const Vector3f right = row.size.y() * frame.right;
    // Right turns to forward clockwise seen from below: it shines downward.
    kit.b.AddFace(is_lit ? kit.m.lamp : kit.m.trim, a, a + forward, a + forward + right, a + right);
    kit.b.set_tint({0.25F, 0.25F, 0.25F, 1});
    AddBeam(kit.m.trim, frame.At(row.x, row.height + 0.031F, -half.x() - 0.02F),
            frame.At(row.x, row.height + 0.031F, half.x() + 0.02F), frame.right,
            row.size.y() + 0.03F, 0.06F, kit.b);
    if (is_lit)
      kit.lamps.push_back(
          {a - 0.012F * Vector3f::UnitZ(), forward, right, radiance * colour, false});
  }
  kit.b.set_tint({1, 1, 1, 1});
}

void AddPipe(float x, float height, float radius, const Rgba& tint, FittingKit& kit) {
  kit.b.set_tint(tint);
  const size_t every = PointsFor(1);
  const size_t count = kit.trail.points().size();
  Vector3f last = StandingFrame(kit, 0).At(x, height);
  const Vector3f first = last;
  for (size_t i = every; i < count; i += every) {
    const Vector3f next = StandingFrame(kit, i).At(x, height + kit.Draw(-0.015, 0.015));
    kit.b.AddTube(kit.m.trim, last, next, radius, radius, 8);
    last = next;
  }
  kit.b.AddTube(kit.m.trim, last, first, radius, radius, 8);
  kit.b.set_tint({1, 1, 1, 1});
}

void AddTimberSets(float spacing, float half_width, float height, FittingKit& kit) {
  const size_t every = PointsFor(spacing);
  for (size_t i = every / 2; i < kit.trail.points().size(); i += every) {
    if (kit.random.Chance(0.1)) continue;
    const TrailFrame frame = StandingFrame(kit, i + static_cast<size_t>(kit.random.Int(3)));
    const float brown = kit.Draw(0.5, 0.95);
    kit.b.set_tint({brown, 0.9F * brown, 0.78F * brown, 1});
    const float thick = kit.Draw(0.14, 0.2);
    for (const float side : {-1.0F, 1.0F}) {
      const float foot = side * (half_width + kit.Draw(0, 0.1));
      kit.b.AddTube(kit.m.bark, frame.At(foot, -0.15F), frame.At(side * half_width * 0.93F, height),
                    0.55F * thick, 0.5F * thick, 9);
    }
    AddBeam(kit.m.bark, frame.At(-half_width - 0.25F, height + 0.5F * thick),
            frame.At(half_width + 0.25F, height + 0.5F * thick + kit.Draw(-0.05, 0.05)),
            Vector3f::UnitZ(), thick, thick, kit.b);
  }
  kit.b.set_tint({1, 1, 1, 1});
}

void AddRails(float gauge, FittingKit& kit) {
  const size_t count = kit.trail.points().size();
  kit.b.set_tint({0.5F, 0.42F, 0.33F, 1});
  for (size_t i = 0; i < count; i += PointsFor(0.75F)) {
    const TrailFrame frame = StandingFrame(kit, i);
    const float turn = kit.Draw(-0.06, 0.06);
    AddBeam(kit.m.bark, frame.At(-0.75F * gauge, 0.02F, -turn),
            frame.At(0.75F * gauge, 0.02F, turn), Vector3f::UnitZ(), 0.08F, 0.16F, kit.b);
  }
  kit.b.set_tint({0.1F, 0.075F, 0.06F, 1});
  const size_t every = PointsFor(0.5F);
  for (const float side : {-0.5F, 0.5F}) {
    for (size_t i = 0; i < count; i += every) {
      const size_t next = i + every < count ? i + every : 0;
      AddBeam(kit.m.metal, StandingFrame(kit, i).At(side * gauge, 0.1F),
              StandingFrame(kit, next).At(side * gauge, 0.1F), Vector3f::UnitZ(), 0.09F, 0.05F,
              kit.b);
    }
  }
  kit.b.set_tint({1, 1, 1, 1});
}

}  // namespace orb360::town
