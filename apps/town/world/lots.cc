#include "apps/town/world/lots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "apps/town/world/ground.h"

namespace orb360::town {
namespace {

/// A lot in the plan.
struct Rectangle {
  Vector2d corner;  ///< front left, seen from the street
  Vector2d right;
  Vector2d back;
  double width;
  double depth;

  Vector2d At(double x, double y) const { return corner + x * right + y * back; }
};

/// Returns true if two rectangles overlap by more than `slack` metres (separating axes).
bool Overlap(const Rectangle& a, const Rectangle& b, double slack) {
  const auto separated = [slack](const Rectangle& r, const Rectangle& other) {
    for (const auto& [axis, length] : {std::pair(r.right, r.width), std::pair(r.back, r.depth)}) {
      double low = 1e30;
      double high = -1e30;
      for (const auto& [x, y] : {std::pair(0.0, 0.0),
                                 {other.width, 0.0},
                                 {0.0, other.depth},
                                 {other.width, other.depth}}) {
        const double along = (other.At(x, y) - r.corner).dot(axis);
        low = std::min(low, along);
        high = std::max(high, along);
      }
      if (high < slack || low > length - slack) return true;
    }
    return false;
  };
  return !separated(a, b) && !separated(b, a);
}

/// Returns true if the whole outline keeps `margin` metres from the carriageways, and out of parks.
bool ClearOfRoads(const StreetPlan& plan, const Rectangle& r, double margin) {
  const auto is_in_park = [&](const Vector2d& p) {
    return std::any_of(plan.parks.begin(), plan.parks.end(),
                       [&](const Park& park) { return park.Contains(p); });
  };
  for (double fraction = 0; fraction <= 1.001; fraction += 0.125) {
    for (const Vector2d& p : {r.At(fraction * r.width, 0), r.At(fraction * r.width, r.depth),
                              r.At(0, fraction * r.depth), r.At(r.width, fraction * r.depth)}) {
      if (plan.DistanceToRoad(p) < margin || is_in_park(p)) return false;
    }
  }
  return true;
}

/// Returns the lot on a rectangle; its base is at the highest point of the terrain below.
Lot OnTerrain(const StreetPlan& plan, const Rectangle& r) {
  double highest = -1e30;
  double lowest = 1e30;
  for (const Vector2d& p : {r.At(0, 0), r.At(r.width, 0), r.At(0, r.depth), r.At(r.width, r.depth),
                            r.At(0.5 * r.width, 0)}) {
    highest = std::max(highest, plan.Height(p));
    lowest = std::min(lowest, plan.Height(p));
  }
  return {Eigen::Vector3d(r.corner.x(), r.corner.y(), highest + kKerbHeight).cast<float>(),
          Eigen::Vector3d(r.right.x(), r.right.y(), 0).cast<float>(), static_cast<float>(r.width),
          static_cast<float>(r.depth), static_cast<float>(highest - lowest)};
}

/// Returns the rectangle across the end of a street that faces the street.
Rectangle AcrossTheEnd(const Street& street, bool at_start, Random& random) {
  const StreetPoint& end = at_start ? street.points.front() : street.points.back();
  Rectangle r;
  r.back = at_start ? Vector2d(-end.tangent) : end.tangent;
  r.right = {r.back.y(), -r.back.x()};
  r.width = random.Uniform(16, 24);
  r.depth = random.Uniform(9, 13);
  r.corner =
      end.position + (end.half_width + street.pavement + 0.5) * r.back - 0.5 * r.width * r.right;
  return r;
}

/// Returns the rectangle behind the pavement on one side of a street (1: left of increasing
/// station, -1: right). Its front is a chord between two stations.
Rectangle AlongKerb(const Street& street, double side, double from, double to, double setback,
                    double depth) {
  const auto kerb_side = [&](double station) -> Vector2d {
    const StreetPoint p = street.At(station);
    const Vector2d left(-p.tangent.y(), p.tangent.x());
    return p.position + side * (p.half_width + street.pavement + setback) * left;
  };
  const Vector2d a = kerb_side(from);
  const Vector2d b = kerb_side(to);
  // Seen from the street, a building on its left has its left end at the lower station.
  Rectangle r;
  r.corner = side > 0 ? a : b;
  r.right = (side > 0 ? Vector2d(b - a) : Vector2d(a - b)).normalized();
  r.back = {-r.right.y(), r.right.x()};
  r.width = (b - a).norm();
  r.depth = depth;
  return r;
}

}  // namespace

std::vector<Lot> LayOutLots(const StreetPlan& plan, Random& random) {
  std::vector<Rectangle> taken;
  std::vector<Lot> lots;
  const auto is_free = [&](const Rectangle& lot) {
    return std::none_of(taken.begin(), taken.end(),
                        [&](const Rectangle& other) { return Overlap(lot, other, 0.4); });
  };
  for (const Bridge& bridge : plan.bridges) {
    const Vector2d across(-bridge.along.y(), bridge.along.x());
    taken.push_back({bridge.centre - bridge.reach * across - bridge.half_width * bridge.along,
                     bridge.along, across, 2 * bridge.half_width, 2 * bridge.reach});
  }
  for (const Street& street : plan.streets) {
    for (const bool at_start : {true, false}) {
      const Rectangle lot = AcrossTheEnd(street, at_start, random);
      if (!ClearOfRoads(plan, lot, street.pavement - 0.6) || !is_free(lot)) continue;
      taken.push_back(lot);
      lots.push_back(OnTerrain(plan, lot));
    }
  }
  for (const Street& street : plan.streets) {
    for (const double side : {1.0, -1.0}) {  // left, right of increasing station
      double s = 1;
      while (s + 6 < street.Length()) {
        const double width = random.Uniform(7, 19);
        const double depth = random.Uniform(9, 14);
        const double setback = random.Chance(0.15) ? random.Uniform(0.5, 3) : 0.0;
        // A smaller house is tried where there is no room for the drawn one: at corners, and where
        // streets are close together.
        std::optional<Rectangle> lot;
        double end = s;
        for (const double fraction : {1.0, 0.8, 0.62}) {
          end = std::min(s + fraction * width, street.Length());
          const Rectangle tried = AlongKerb(street, side, s, end, setback, fraction * depth);
          if (tried.width <= 5 || !ClearOfRoads(plan, tried, street.pavement - 0.6) ||
              !is_free(tried))
            continue;
          lot = tried;
          break;
        }
        if (!lot) {
          s += 1.5;
          continue;
        }
        taken.push_back(*lot);
        lots.push_back(OnTerrain(plan, *lot));
        s = end + (random.Chance(0.12) ? random.Uniform(2, 6) : 0.02);
      }
    }
  }
  return lots;
}

}  // namespace orb360::town
