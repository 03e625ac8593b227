#include "apps/town/world/road_details.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace orb360::town {
namespace {

// Heights above the asphalt, metres: above the triangles of a slope, which deviate by up to 0.4 mm,
// and below the road paint.
constexpr double kPatchHeight = 0.0008;
constexpr double kIronHeight = 0.0014;

/// A coordinate frame on a street: station and offset to the left, metres.
class StreetFrame {
 public:
  StreetFrame(const StreetPlan& plan, const Street& street) : plan_(&plan), street_(&street) {}

  /// Returns true if the edges of a piece lie on the carriageway and not on an island in it.
  bool IsRoad(double s0, double s1, double y0, double y1) const {
    for (const double fraction : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const double s = std::lerp(s0, s1, fraction);
      const double y = std::lerp(y0, y1, fraction);
      for (const auto& [station, offset] :
           {std::pair(s, y0), std::pair(s, y1), std::pair(s0, y), std::pair(s1, y)}) {
        if (plan_->DistanceToRoad(PlanAt(station, offset)) > 0) return false;
      }
    }
    return true;
  }
  Vector3f At(double station, double offset, double height) const {
    const Vector2d q = PlanAt(station, offset);
    return Eigen::Vector3d(q.x(), q.y(), plan_->Height(q) + height).cast<float>();
  }

 private:
  Vector2d PlanAt(double station, double offset) const {
    const StreetPoint p = street_->At(station);
    return p.position + offset * Vector2d(-p.tangent.y(), p.tangent.x());
  }

  const StreetPlan* plan_;
  const Street* street_;
};

/// Adds a rectangle along the street in pieces that follow the slope.
void AddPatch(const StreetFrame& frame, MaterialId material, double s0, double s1, double y0,
              double y1, double height, MeshBuilder& b) {
  const int along = std::max(1, static_cast<int>(std::ceil(s1 - s0)));
  const int across = std::max(1, static_cast<int>(std::ceil(y1 - y0)));
  for (int i = 0; i < along; ++i) {
    const double a = std::lerp(s0, s1, static_cast<double>(i) / along);
    const double c = std::lerp(s0, s1, static_cast<double>(i + 1) / along);
    for (int j = 0; j < across; ++j) {
      const double l = std::lerp(y0, y1, static_cast<double>(j) / across);
      const double r = std::lerp(y0, y1, static_cast<double>(j + 1) / across);
      b.AddGroundPolygon(material, {frame.At(a, l, height), frame.At(c, l, height),
                                    frame.At(c, r, height), frame.At(a, r, height)});
    }
  }
}

/// Adds a piece of new asphalt with the tar of its seam around it.
void AddMendedPiece(const StreetFrame& frame, double s0, double s1, double y0, double y1,
                    Random& random, MeshBuilder& b) {
  if (!frame.IsRoad(s0, s1, y0, y1)) return;
  const MaterialId asphalt = b.materials().fresh_asphalt;
  constexpr double kSeam = 0.035;  // metres
  const auto shade = static_cast<float>(random.Uniform(0.6, 1.0));
  b.set_tint({shade, shade, shade, 1});
  AddPatch(frame, asphalt, s0 + kSeam, s1 - kSeam, y0 + kSeam, y1 - kSeam, kPatchHeight, b);
  b.set_tint({0.4F, 0.4F, 0.4F, 1});
  AddPatch(frame, asphalt, s0, s1, y0, y0 + kSeam, kPatchHeight, b);
  AddPatch(frame, asphalt, s0, s1, y1 - kSeam, y1, kPatchHeight, b);
  AddPatch(frame, asphalt, s0, s0 + kSeam, y0 + kSeam, y1 - kSeam, kPatchHeight, b);
  AddPatch(frame, asphalt, s1 - kSeam, s1, y0 + kSeam, y1 - kSeam, kPatchHeight, b);
}

/// Adds a round cover: the inscribed disc of the texture.
void AddManhole(const StreetFrame& frame, double station, double offset, MeshBuilder& b) {
  constexpr double kRadius = 0.33;  // metres
  constexpr int kSides = 20;
  if (!frame.IsRoad(station - kRadius, station + kRadius, offset - kRadius, offset + kRadius))
    return;
  b.set_tint({1, 1, 1, 1});
  const auto rim = [&](int i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const auto u = static_cast<float>(0.5 + 0.5 * std::cos(angle));
    const auto v = static_cast<float>(0.5 + 0.5 * std::sin(angle));
    return b.AddVertex(frame.At(station + kRadius * std::cos(angle),
                                offset + kRadius * std::sin(angle), kIronHeight),
                       Vector3f::UnitZ(), u, v);
  };
  const uint32_t centre =
      b.AddVertex(frame.At(station, offset, kIronHeight), Vector3f::UnitZ(), 0.5F, 0.5F);
  uint32_t previous = rim(0);
  for (int i = 1; i <= kSides; ++i) {
    const uint32_t next = rim(i);
    b.AddTriangle(b.materials().manhole, centre, previous, next);
    previous = next;
  }
}

void AddDrain(const StreetFrame& frame, double station, double offset, MeshBuilder& b) {
  constexpr double kLength = 0.5;
  constexpr double kWidth = 0.36;
  const double y0 = offset - 0.5 * kWidth;
  const double y1 = offset + 0.5 * kWidth;
  if (!frame.IsRoad(station, station + kLength, y0, y1)) return;
  b.set_tint({1, 1, 1, 1});
  b.AddQuad(b.materials().drain,
            {frame.At(station, y0, kIronHeight), frame.At(station + kLength, y0, kIronHeight),
             frame.At(station + kLength, y1, kIronHeight), frame.At(station, y1, kIronHeight)},
            {Vector2f(0, 0), Vector2f(1, 0), Vector2f(1, 1), Vector2f(0, 1)});
}

}  // namespace

void AddRoadDetails(const StreetPlan& plan, Random random, MeshBuilder& b) {
  for (size_t index = 0; index < plan.streets.size(); ++index) {
    const Street& street = plan.streets[index];
    const StreetFrame frame(plan, street);
    const double length = street.Length();
    // Nothing is placed where streets meet, because pieces of two streets would overlap.
    const auto clear = [&](double s) {
      return plan.DistanceToOtherRoads(street.At(s).position, index) >
             1.5 + street.At(s).half_width;
    };
    const auto half_width = [&street](double s) { return street.At(s).half_width; };
    for (double s = random.Uniform(2, 12); s < length - 7; s += random.Uniform(9, 26)) {
      if (!clear(s) || !clear(s + 6)) continue;
      if (random.Chance(0.15)) {  // a trench from kerb to kerb
        const double end = s + random.Uniform(0.5, 1.1);
        const double edge = std::min(half_width(s), half_width(end)) - 0.02;
        AddMendedPiece(frame, s, end, -edge, edge, random, b);
      } else {
        const double end = s + random.Uniform(0.8, 6);
        const double width = random.Uniform(0.6, 2.2);
        const double edge = std::min(half_width(s), half_width(end)) - 0.02;
        const double y0 = random.Uniform(-edge, edge - width);
        AddMendedPiece(frame, s, end, y0, y0 + width, random, b);
      }
    }
    for (double s = random.Uniform(2, 20); s < length - 2; s += random.Uniform(14, 32)) {
      if (!clear(s)) continue;
      const double edge = half_width(s) - 0.9;
      AddManhole(frame, s, random.Uniform(-edge, edge), b);
      if (random.Chance(0.25)) AddManhole(frame, s + 1.1, random.Uniform(-edge, edge), b);
    }
    for (const double side : {-1.0, 1.0}) {
      for (double s = random.Uniform(4, 20); s < length - 2; s += random.Uniform(16, 26))
        if (clear(s)) AddDrain(frame, s, side * (half_width(s) - 0.22), b);
    }
  }
}

}  // namespace orb360::town
