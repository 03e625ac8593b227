#include "apps/town/drive/route_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace orb360::town {
namespace {

constexpr double kStep = 0.05;        // seconds between states
constexpr float kSpacing = 0.05F;     // metres between points of a route
constexpr double kFastestTurn = 1.1;  // radians per second
constexpr double kSlowest = 0.15;     // metres per second, in the sharpest bends

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

std::vector<Vector2f> ResampleRoute(const std::vector<Vector2f>& route) {
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

RouteWalk::RouteWalk(const std::vector<Vector2f>& route, double speed)
    : states_(StatesAlong(ResampleRoute(route), speed)) {}

double RouteWalk::duration() const { return kStep * static_cast<double>(states_.size() - 1); }

WalkState RouteWalk::At(double time) const {
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
