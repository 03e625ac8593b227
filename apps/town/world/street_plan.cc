#include "apps/town/world/street_plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/town/image/random.h"
#include "apps/town/world/places.h"
#include "apps/town/world/tour.h"

namespace orb360::town {
namespace {

constexpr double kSampleSpacing = 1.0;    // metres between the points of a centreline
constexpr double kAvenueSpacing = 45;     // metres between streets from which on one is an avenue
constexpr double kAvenueHalfWidth = 8.4;  // metres: median, lane and parked cars
constexpr double kMedian = 1.6;           // metres, half of the avenue's median

/// Range from which widths of streets are drawn, metres.
struct Widths {
  double least_half_width, most_half_width;  // of the carriageway
  double least_pavement, most_pavement;
};
constexpr Widths kUsualWidths = {3.3, 6.9, 2.2, 4.2};
/// Widths in an old town, whose streets are closer together than kAvenueSpacing. Wide streets would
/// leave no blocks to build on there.
constexpr Widths kNarrowWidths = {3.2, 4.1, 1.6, 2.3};

/// Uniform Catmull-Rom curve, which passes through p1 at t = 0 and through p2 at t = 1.
Vector2d CatmullRom(const Vector2d& p0, const Vector2d& p1, const Vector2d& p2, const Vector2d& p3,
                    double t) {
  return 0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t * t +
                (3 * p1 - p0 - 3 * p2 + p3) * t * t * t);
}

/// Returns the street through `knots`, and the station of each knot.
Street MakeStreet(const std::vector<Vector2d>& knots, double half_width, double width_change,
                  double phase, std::vector<double>* knot_stations) {
  Street street;
  double station = 0;
  Vector2d previous = knots.front();
  knot_stations->assign(1, 0.0);
  for (size_t i = 0; i + 1 < knots.size(); ++i) {
    const Vector2d before = i == 0 ? Vector2d(2 * knots[0] - knots[1]) : knots[i - 1];
    const Vector2d after =
        i + 2 < knots.size() ? knots[i + 2] : Vector2d(2 * knots[i + 1] - knots[i]);
    const int steps =
        std::max(2, static_cast<int>((knots[i + 1] - knots[i]).norm() / kSampleSpacing));
    for (int k = i == 0 ? 0 : 1; k <= steps; ++k) {
      const Vector2d p =
          CatmullRom(before, knots[i], knots[i + 1], after, static_cast<double>(k) / steps);
      station += (p - previous).norm();
      previous = p;
      street.points.push_back({p, Vector2d::Zero(), station,
                               half_width + width_change * std::sin(station / 23.0 + phase)});
    }
    knot_stations->push_back(station);
  }
  for (size_t i = 0; i < street.points.size(); ++i) {
    const size_t low = i == 0 ? 0 : i - 1;
    const size_t high = std::min(i + 1, street.points.size() - 1);
    street.points[i].tangent =
        (street.points[high].position - street.points[low].position).normalized();
  }
  return street;
}

/// Returns the signed distance to the edge of one street's carriageway, or `bound` if that is less.
double DistanceToStreet(const Street& street, const Vector2d& p, double bound) {
  double best = bound;
  // The distance of each point bounds the distance to its neighbourhood, so far stretches are
  // skipped.
  for (size_t i = 0; i + 1 < street.points.size();) {
    const StreetPoint& a = street.points[i];
    const double to_point = (p - a.position).norm() - a.half_width;
    if (to_point - best > 3.0) {
      i += static_cast<size_t>((to_point - best) / 2.0);
      continue;
    }
    const StreetPoint& b = street.points[i + 1];
    const Vector2d ab = b.position - a.position;
    const double t = std::clamp((p - a.position).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    best =
        std::min(best, (p - a.position - t * ab).norm() - std::lerp(a.half_width, b.half_width, t));
    ++i;
  }
  return best;
}

/// Returns the minimum, rounded where the two values are closer than `radius`.
double SmoothMinimum(double a, double b, double radius) {
  const double h = std::max(radius - std::abs(a - b), 0.0) / radius;
  return std::min(a, b) - 0.25 * h * h * radius;
}

}  // namespace

StreetPoint Street::At(double station) const {
  const auto above = std::lower_bound(points.begin(), points.end(), station,
                                      [](const StreetPoint& p, double s) { return p.station < s; });
  if (above == points.begin()) return points.front();
  if (above == points.end()) return points.back();
  const StreetPoint& b = *above;
  const StreetPoint& a = *(above - 1);
  const double t = (station - a.station) / (b.station - a.station);
  return {a.position + t * (b.position - a.position),
          (a.tangent + t * (b.tangent - a.tangent)).normalized(), station,
          std::lerp(a.half_width, b.half_width, t)};
}

double StreetPlan::Height(const Vector2d& p) const {
  return 1.5 * std::sin(p.x() / 37.0 + hill_phase) +
         1.2 * std::sin(p.y() / 43.0 + 1.7 * hill_phase) +
         2.0 * std::sin((p.x() + p.y()) / 95.0 + 2.3 * hill_phase);
}

double Island::Distance(const Vector2d& p) const {
  double nearest = (p - spine.front()).norm();
  for (size_t i = 0; i + 1 < spine.size(); ++i) {
    const Vector2d ab = spine[i + 1] - spine[i];
    const double t = std::clamp((p - spine[i]).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - spine[i] - t * ab).norm());
  }
  return nearest - radius;
}

bool Park::Contains(const Vector2d& p) const {
  // Counts the sides that a ray towards +x crosses.
  bool inside = false;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vector2d& a = outline[i];
    const Vector2d& b = outline[(i + 1) % outline.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()) > p.x()) inside = !inside;
  }
  return inside;
}

double StreetPlan::DistanceToOtherRoads(const Vector2d& p, size_t except) const {
  constexpr double kCornerBlend = 7.0;  // metres: gives kerb radii of about 5 m
  double distance = 1e30;
  for (const Roundabout& roundabout : roundabouts)
    distance = std::min(distance, (p - roundabout.centre).norm() - roundabout.outer_radius);
  for (size_t i = 0; i < streets.size(); ++i) {
    if (i == except) continue;
    const double other = DistanceToStreet(streets[i], p, distance + kCornerBlend);
    distance = SmoothMinimum(distance, other, kCornerBlend);
  }
  return distance;
}

double StreetPlan::DistanceToRoad(const Vector2d& p) const {
  double distance = DistanceToOtherRoads(p, streets.size());
  if (distance > 0) return distance;
  for (const Island& island : islands) {
    // The distances of the spine's ends bound the distance to all of it.
    const double bound = 0.5 * ((p - island.spine.front()).norm() +
                                (p - island.spine.back()).norm() - island.length) -
                         island.radius;
    if (-bound > distance) distance = std::max(distance, -island.Distance(p));
  }
  return distance;
}

const Roundabout* StreetPlan::RoundaboutAt(size_t junction) const {
  const auto found = std::find_if(roundabouts.begin(), roundabouts.end(),
                                  [&](const Roundabout& r) { return r.junction == junction; });
  return found == roundabouts.end() ? nullptr : &*found;
}

bool StreetPlan::IsUnderBridge(size_t street, double station, double margin) const {
  return std::any_of(bridges.begin(), bridges.end(), [&](const Bridge& bridge) {
    return bridge.street == street &&
           std::abs(bridge.station - station) < bridge.half_width + margin;
  });
}

double StreetPlan::PavementAt(const Vector2d& p) const {
  constexpr double kIslandEdge = 0.4;  // metres
  constexpr double kAbout = 1.5;       // metres: ground is laid in cells that reach across kerbs
  for (const Island& island : islands) {
    if (island.Distance(p) < kAbout) return kIslandEdge;
  }
  double best = 1e30;
  double pavement = 3;
  for (const Street& street : streets) {
    const double distance = DistanceToStreet(street, p, best);
    if (distance < best) {
      best = distance;
      pavement = street.pavement;
    }
  }
  return pavement;
}

StreetPlan PlanStreets(const PlanOptions& options) {
  Random random(options.seed);
  StreetPlan plan;
  plan.hill_phase = random.Uniform(0, 6.28);
  const int columns = options.columns;
  const int rows = options.rows;
  const auto node = [columns](int column, int row) {
    return static_cast<size_t>(row * columns + column);
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = (column - 0.5 * (columns - 1)) * options.spacing;
      const double y = (row - 0.5 * (rows - 1)) * options.spacing;
      const double jitter = 0.17 * options.spacing;
      plan.junctions.push_back(
          {{x + random.Uniform(-jitter, jitter), y + random.Uniform(-jitter, jitter)}, {}});
    }
  }
  const size_t avenue = options.spacing >= kAvenueSpacing
                            ? static_cast<size_t>(random.Fork(3).Int(rows + columns))
                            : static_cast<size_t>(rows + columns);
  const Widths& widths = options.spacing >= kAvenueSpacing ? kUsualWidths : kNarrowWidths;
  const auto add_street = [&](const std::vector<size_t>& nodes) {
    // Streets continue beyond the outer junctions, and bend between junctions.
    std::vector<Vector2d> knots;
    std::vector<size_t> knot_of_node;
    const auto at = [&](size_t i) { return plan.junctions[nodes[i]].position; };
    const double extent = random.Uniform(45, 60);
    knots.push_back(at(0) - extent * (at(1) - at(0)).normalized());
    for (size_t i = 0; i < nodes.size(); ++i) {
      knot_of_node.push_back(knots.size());
      knots.push_back(at(i));
      if (i + 1 < nodes.size()) {
        const Vector2d along = at(i + 1) - at(i);
        const Vector2d across(-along.y(), along.x());
        knots.emplace_back(at(i) + 0.5 * along + random.Uniform(-0.09, 0.09) * across);
      }
    }
    knots.push_back(at(nodes.size() - 1) +
                    extent * (at(nodes.size() - 1) - at(nodes.size() - 2)).normalized());
    std::vector<double> stations;
    const bool is_avenue = plan.streets.size() == avenue;
    const double half_width = random.Uniform(widths.least_half_width, widths.most_half_width);
    const double width_change = random.Uniform(0.0, 0.3);
    Street street = MakeStreet(knots, is_avenue ? kAvenueHalfWidth : half_width, width_change,
                               random.Uniform(0, 6.28), &stations);
    street.pavement = random.Uniform(widths.least_pavement, widths.most_pavement);
    street.parking = street.points.front().half_width > 5.2;
    street.has_centre_line = random.Chance(0.8) && !is_avenue;
    if (is_avenue) {
      street.pavement = 4.5;
      street.median = kMedian;
    }
    for (size_t i = 0; i < nodes.size(); ++i) {
      plan.junctions[nodes[i]].arms.push_back({plan.streets.size(), stations[knot_of_node[i]]});
    }
    plan.streets.push_back(std::move(street));
  };
  for (int row = 0; row < rows; ++row) {
    std::vector<size_t> nodes;
    for (int column = 0; column < columns; ++column) nodes.push_back(node(column, row));
    add_street(nodes);
  }
  for (int column = 0; column < columns; ++column) {
    std::vector<size_t> nodes;
    for (int row = 0; row < rows; ++row) nodes.push_back(node(column, row));
    add_street(nodes);
  }
  plan.tour = PlanTour({columns, rows, options.tour_blocks}, random.Fork(1));
  plan.other_tours = PlanOtherTours(plan.tour, columns, rows, random.Fork(2));
  AddPlaces(columns, rows, options.spacing, random.Fork(4), &plan);
  return plan;
}

}  // namespace orb360::town
