#include "apps/town/drive/driven_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// A stretch of one street between two junctions, in driving direction.
struct Leg {
  size_t street;
  double from;
  double to;
};

/// Returns the street that joins two junctions.
Leg FindLeg(const StreetPlan& plan, size_t from, size_t to) {
  for (const Junction::Arm& a : plan.junctions[from].arms) {
    for (const Junction::Arm& b : plan.junctions[to].arms) {
      if (a.street == b.street) return {a.street, a.station, b.station};
    }
  }
  ORB360_CHECK(false, "no street joins the junctions", from, to);
  return {};
}

LinePoint LanePoint(const StreetPlan& plan, const Leg& leg, double station) {
  const Street& street = plan.streets[leg.street];
  const StreetPoint p = street.At(station);
  const double direction = leg.to > leg.from ? 1 : -1;
  const Vector2d right(direction * p.tangent.y(), -direction * p.tangent.x());
  const double offset = street.LaneOffset(p.half_width);
  const Vector2d position = p.position + offset * right;
  return {position.x(), position.y(),
          p.half_width - (street.parking ? kParkingWidth : 0.0) - offset};
}

Vector2d LaneDirection(const StreetPlan& plan, const Leg& leg, double station) {
  return (leg.to > leg.from ? 1 : -1) * plan.streets[leg.street].At(station).tangent;
}

/// Adds a cubic curve between two points with given directions (unit vectors), without its end.
void AddCurve(const LinePoint& from, const Vector2d& from_direction, const LinePoint& to,
              const Vector2d& to_direction, std::vector<LinePoint>* ring) {
  constexpr int kPieces = 40;
  const double reach = 0.45 * (to - from).head<2>().norm();
  LinePoint p1 = from;
  LinePoint p2 = to;
  p1.head<2>() += reach * from_direction;
  p2.head<2>() -= reach * to_direction;
  for (int k = 0; k < kPieces; ++k) {
    const double t = static_cast<double>(k) / kPieces;
    const double q = 1 - t;
    ring->emplace_back(q * q * q * from + 3 * q * q * t * p1 + 3 * q * t * t * p2 + t * t * t * to);
  }
}

/// Adds the way from one street round the island, counter-clockwise, into another, without the last
/// point.
void AddRound(const Roundabout& roundabout, const LinePoint& from, const Vector2d& from_direction,
              const LinePoint& to, const Vector2d& to_direction, std::vector<LinePoint>* ring) {
  constexpr double kFlare = 0.7;  // radians between a street and where it joins the circle, at most
  const double radius = 0.5 * (roundabout.island_radius + roundabout.outer_radius);
  const auto angle_of = [&](const LinePoint& p) {
    return std::atan2(p.y() - roundabout.centre.y(), p.x() - roundabout.centre.x());
  };
  const auto direction_at = [](double angle) -> Vector2d {
    return {-std::sin(angle), std::cos(angle)};
  };
  const auto on_circle = [&](double angle) -> LinePoint {
    const Vector2d p = roundabout.centre + radius * Vector2d(std::cos(angle), std::sin(angle));
    return {p.x(), p.y(), roundabout.outer_radius - radius};
  };
  const double entry = angle_of(from);
  double turn = angle_of(to) - entry;
  turn -= 2 * std::numbers::pi * std::floor(turn / (2 * std::numbers::pi));
  const double flare = std::min(kFlare, 0.4 * turn);
  const double first = entry + flare;
  const double last = entry + turn - flare;
  AddCurve(from, from_direction, on_circle(first), direction_at(first), ring);
  const int pieces = std::max(1, static_cast<int>(radius * (last - first) / 0.5));
  for (int k = 0; k < pieces; ++k)
    ring->push_back(on_circle(std::lerp(first, last, static_cast<double>(k) / pieces)));
  AddCurve(on_circle(last), direction_at(last), to, to_direction, ring);
}

}  // namespace

std::vector<LinePoint> DrivenLine(const StreetPlan& plan, std::span<const size_t> tour,
                                  std::vector<size_t>* junction_points) {
  constexpr double kApproach = 11;      // metres from the junction at which a turn begins and ends
  constexpr double kRoundApproach = 7;  // metres from a roundabout's carriageway, likewise
  const size_t n = tour.size();
  std::vector<Leg> legs;
  for (size_t i = 0; i < n; ++i) legs.push_back(FindLeg(plan, tour[i], tour[(i + 1) % n]));
  // Length, before and behind the junction where a leg begins, that is driven on a curve, metres.
  const auto trim = [&](size_t i) {
    const Roundabout* roundabout = plan.RoundaboutAt(tour[i % n]);
    if (roundabout != nullptr) return roundabout->outer_radius + kRoundApproach;
    return legs[(i + n - 1) % n].street == legs[i % n].street ? 0.0 : kApproach;
  };
  std::vector<LinePoint> ring;
  for (size_t i = 0; i < n; ++i) {
    const Leg& leg = legs[i];
    const Leg& next = legs[(i + 1) % n];
    const double direction = leg.to > leg.from ? 1 : -1;
    const double next_direction = next.to > next.from ? 1 : -1;
    const double end = leg.to - direction * trim(i + 1);
    for (double s = leg.from + direction * trim(i); direction * (end - s) > 0; s += direction * 0.5)
      ring.push_back(LanePoint(plan, leg, s));
    junction_points->push_back(ring.size());
    if (trim(i + 1) == 0) continue;
    const double exit = next.from + next_direction * trim(i + 1);
    const LinePoint from = LanePoint(plan, leg, end);
    const LinePoint to = LanePoint(plan, next, exit);
    const Vector2d from_direction = LaneDirection(plan, leg, end);
    const Vector2d to_direction = LaneDirection(plan, next, exit);
    const Roundabout* roundabout = plan.RoundaboutAt(tour[(i + 1) % n]);
    if (roundabout != nullptr)
      AddRound(*roundabout, from, from_direction, to, to_direction, &ring);
    else
      AddCurve(from, from_direction, to, to_direction, &ring);
  }
  return ring;
}

}  // namespace orb360::town
