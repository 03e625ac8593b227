#include "apps/town/drive/indoor_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "apps/town/world/interior/free_space.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr double kStep = 0.05;        // seconds between states
constexpr float kSpacing = 0.05F;     // metres between points of a route
constexpr double kFastestTurn = 1.1;  // radians per second
constexpr double kSlowest = 0.15;     // metres per second, in the sharpest bends

constexpr size_t kFewestCells = 20;  // of a room that is entered

/// Returns the cells of each room that can be reached; rooms with few are left out.
std::vector<std::vector<FreeSpace::Cell>> CellsByRoom(const FloorPlan& plan,
                                                      const FreeSpace& space) {
  std::vector<std::vector<FreeSpace::Cell>> cells(plan.rooms.size());
  for (const FreeSpace::Cell cell : space.reachable()) {
    for (size_t i = 0; i < plan.rooms.size(); ++i) {
      if (plan.rooms[i].area.Contains(space.Middle(cell))) cells[i].push_back(cell);
    }
  }
  std::erase_if(cells, [](const auto& list) { return list.size() < kFewestCells; });
  return cells;
}

/// Returns a way through the cells, at least `length` metres long.
std::vector<Vector2f> PlanRoute(const FloorPlan& plan, const FreeSpace& space, double length,
                                Random& random) {
  const auto rooms = CellsByRoom(plan, space);
  ORB360_CHECK(!rooms.empty(), plan.rooms.size());
  std::vector<size_t> order(rooms.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Vector2f> route;
  double walked = 0;
  auto here = random.Pick(std::span<const FreeSpace::Cell>(rooms[0]));
  while (walked < length) {
    for (size_t i = order.size() - 1; i > 0; --i)
      std::swap(order[i], order[static_cast<size_t>(random.Int(static_cast<int>(i) + 1))]);
    for (const size_t room : order) {
      for (int stops = 1 + random.Int(2); stops > 0; --stops) {
        const auto to = random.Pick(std::span<const FreeSpace::Cell>(rooms[room]));
        for (const FreeSpace::Cell cell : space.Path(here, to)) {
          if (!route.empty()) walked += (space.Middle(cell) - route.back()).norm();
          route.push_back(space.Middle(cell));
        }
        here = to;
      }
    }
  }
  return route;
}

std::vector<Vector2f> Resampled(const std::vector<Vector2f>& route) {
  std::vector<Vector2f> points = {route.front()};
  float rest = kSpacing;
  for (size_t i = 1; i < route.size(); ++i) {
    const Vector2f way = route[i] - route[i - 1];
    const float length = way.norm();
    float at = rest;
    for (; at <= length; at += kSpacing) points.push_back(route[i - 1] + at / length * way);
    rest = at - length;
  }
  return points;
}

/// Moves points towards the middle of their neighbours as long as they stay clear of obstacles.
void Smooth(const FreeSpace& space, std::vector<Vector2f>* points) {
  constexpr int kRounds = 60;
  constexpr float kKept = IndoorWalk::kClearance + 0.03F;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Vector2f> last = *points;
    for (size_t i = 1; i + 1 < points->size(); ++i) {
      const size_t reach = std::min<size_t>({4, i, points->size() - 1 - i});
      const Vector2f middle = 0.5F * (last[i - reach] + last[i + reach]);
      const Vector2f moved = 0.5F * (last[i] + middle);
      if ((moved - last[i]).squaredNorm() > 1e-8F && space.Clearance(moved) >= kKept)
        (*points)[i] = moved;
    }
  }
}

/// Returns the mean over `reach` values on either side.
std::vector<double> Averaged(const std::vector<double>& values, size_t reach) {
  std::vector<double> sums(values.size() + 1);
  std::partial_sum(values.begin(), values.end(), sums.begin() + 1);
  std::vector<double> means(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    const size_t begin = i < reach ? 0 : i - reach;
    const size_t end = std::min(values.size(), i + reach + 1);
    means[i] = (sums[end] - sums[begin]) / static_cast<double>(end - begin);
  }
  return means;
}

/// Returns the direction of the route at each point, without jumps.
std::vector<double> Headings(const std::vector<Vector2f>& points) {
  std::vector<double> headings(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector2f way = points[std::min(i + 2, points.size() - 1)] - points[i < 2 ? 0 : i - 2];
    const double last = i == 0 ? 0 : headings[i - 1];
    if (way.norm() < 1e-4F) {
      headings[i] = last;
      continue;
    }
    const double heading = std::atan2(way.y(), way.x());
    headings[i] = i == 0 ? heading : last + std::remainder(heading - last, 2 * std::numbers::pi);
  }
  return headings;
}

/// Returns the states along a route, slower in bends.
std::vector<WalkState> StatesAlong(const std::vector<Vector2f>& points, double speed) {
  const std::vector<double> headings = Averaged(Averaged(Headings(points), 8), 8);
  std::vector<double> speeds(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const double turn = std::abs(headings[std::min(i + 1, points.size() - 1)] - headings[i]);
    speeds[i] = std::clamp(kFastestTurn * kSpacing / (turn + 1e-6), kSlowest, speed);
  }
  speeds = Averaged(Averaged(speeds, 5), 5);
  std::vector<WalkState> states;
  double station = 0;  // points along the route
  const auto last = static_cast<double>(points.size() - 1);
  while (station < last) {
    const auto i = static_cast<size_t>(station);
    const double t = station - static_cast<double>(i);
    const Vector2f p = points[i] + static_cast<float>(t) * (points[i + 1] - points[i]);
    states.push_back(
        {p.cast<double>(), headings[i] + t * (headings[i + 1] - headings[i]), station * kSpacing});
    station += speeds[i] * kStep / kSpacing;
  }
  return states;
}

}  // namespace

IndoorWalk::IndoorWalk(const FloorPlan& plan, const std::vector<Area>& taken,
                       const WalkOptions& options, Random random) {
  const FreeSpace space(plan, taken);
  // Bends and smoothing make a route shorter in time than it was planned; then a longer one is.
  double length = 1.1 * options.speed * options.duration + 5;  // metres
  while (states_.empty() || duration() < options.duration) {
    Random draw = random;
    std::vector<Vector2f> points = Resampled(PlanRoute(plan, space, length, draw));
    Smooth(space, &points);
    states_ = StatesAlong(Resampled(points), options.speed);
    length *= 1.3;
  }
}

double IndoorWalk::duration() const { return kStep * static_cast<double>(states_.size() - 1); }

WalkState IndoorWalk::At(double time) const {
  // Cubic B-splines smooth the states and stay within their hull.
  const double at = std::clamp(time, 0.0, duration()) / kStep;
  const auto i = static_cast<int>(at);
  const double t = at - i;
  const double s = 1 - t;
  const std::array<double, 4> weights = {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                                         (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
  WalkState state{Eigen::Vector2d::Zero()};
  for (int k = 0; k < 4; ++k) {
    const int index = std::clamp(i + k - 1, 0, static_cast<int>(states_.size()) - 1);
    const WalkState& knot = states_[static_cast<size_t>(index)];
    const double weight = weights[static_cast<size_t>(k)];
    state.position += weight * knot.position;
    state.heading += weight * knot.heading;
    state.distance += weight * knot.distance;
  }
  return state;
}

}  // namespace orb360::town
