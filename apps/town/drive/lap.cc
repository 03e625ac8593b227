#include "apps/town/drive/lap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/town/image/random.h"
#include "slam/check.h"

namespace orb360::town {
namespace {

constexpr double kStep = 0.25;                // metres between the points of the driven line
constexpr double kLateralAcceleration = 4.0;  // metres per second squared, in bends
constexpr double kBraking = 2.8;              // metres per second squared
constexpr double kAccelerating = 2.4;

/// A stretch of one street between two junctions, as driven.
struct Leg {
  size_t street;
  double from;
  double to;
};

/// The street that joins two junctions.
Leg FindLeg(const StreetPlan& plan, size_t from, size_t to) {
  for (const Junction::Arm& a : plan.junctions[from].arms) {
    for (const Junction::Arm& b : plan.junctions[to].arms) {
      if (a.street == b.street) return {a.street, a.station, b.station};
    }
  }
  ORB360_CHECK(false, "no street joins the junctions", from, to);
  return {};
}

/// A point of the driven line: its place in the plan, and as z the metres to the kerb on the right,
/// or to the cars parked there.
using LinePoint = Eigen::Vector3d;

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

/// Points every kStep metres along a polyline, closed into a ring.
std::vector<LinePoint> Resample(const std::vector<LinePoint>& ring) {
  std::vector<LinePoint> result;
  double carried = 0;  // metres since the last point
  for (size_t i = 0; i < ring.size(); ++i) {
    const LinePoint& a = ring[i];
    const LinePoint& b = ring[(i + 1) % ring.size()];
    const double length = (b - a).head<2>().norm();
    if (length < 1e-9) continue;
    double s = kStep - carried;
    for (; s <= length; s += kStep) result.emplace_back(a + s / length * (b - a));
    carried = length - (s - kStep);
  }
  return result;
}

/// A cubic curve between two points with given directions (unit vectors), without its end.
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

/// From one street round the island, counter-clockwise, into another, without the last point.
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

/// The driven line as a ring: lanes joined at the junctions by curves.
std::vector<LinePoint> DrivenLine(const StreetPlan& plan, std::span<const size_t> tour,
                                  std::vector<size_t>* junction_points) {
  constexpr double kApproach = 11;      // metres from the junction at which a turn begins and ends
  constexpr double kRoundApproach = 7;  // metres from a roundabout's carriageway, likewise
  const size_t n = tour.size();
  std::vector<Leg> legs;
  for (size_t i = 0; i < n; ++i) legs.push_back(FindLeg(plan, tour[i], tour[(i + 1) % n]));
  // Metres before and behind the junction where a leg begins that are driven on a curve.
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

/// Circular moving average over 2 * radius + 1 values.
template <typename T>
std::vector<T> SmoothRing(const std::vector<T>& values, int radius) {
  const int n = static_cast<int>(values.size());
  std::vector<T> result;
  for (int i = 0; i < n; ++i) {
    T sum = values[static_cast<size_t>((i - radius + n) % n)];
    for (int k = -radius + 1; k <= radius; ++k) sum += values[static_cast<size_t>((i + k + n) % n)];
    result.push_back(sum / (2 * radius + 1));
  }
  return result;
}

/// What drivers wish for, changing every 30 m or so, within what the bends allow.
std::vector<double> WishedSpeeds(const std::vector<Vector2d>& points, const LapOptions& options,
                                 Random& random) {
  const size_t n = points.size();
  std::vector<double> wish(n);
  double target = options.maximum_speed;
  for (size_t i = 0; i < n; ++i) {
    if (i % static_cast<size_t>(30 / kStep) == 0)
      target = random.Uniform(options.minimum_speed, options.maximum_speed);
    wish[i] = target;
  }
  wish = SmoothRing(wish, static_cast<int>(6 / kStep));
  constexpr size_t kReach = 8;  // points to either side over which the curvature is taken
  for (size_t i = 0; i < n; ++i) {
    const Vector2d ab = points[i] - points[(i + n - kReach) % n];
    const Vector2d bc = points[(i + kReach) % n] - points[i];
    const double turn = std::abs(std::atan2(ab.x() * bc.y() - ab.y() * bc.x(), ab.dot(bc)));
    const double curvature = turn / (0.5 * (ab.norm() + bc.norm()));
    wish[i] = std::min(wish[i], std::sqrt(kLateralAcceleration / std::max(curvature, 1e-4)));
  }
  return wish;
}

}  // namespace

Lap::Lap(const StreetPlan& plan, std::span<const size_t> tour, const LapOptions& options)
    : plan_(&plan) {
  Random random(options.seed);
  std::vector<size_t> junction_points;
  const std::vector<LinePoint> line = DrivenLine(plan, tour, &junction_points);
  for (const LinePoint& p : SmoothRing(Resample(line), 7)) {
    points_.emplace_back(p.head<2>());
    room_.push_back(std::min(p.z(), -plan.DistanceToRoad(p.head<2>())));
  }
  const size_t n = points_.size();
  speeds_ = WishedSpeeds(points_, options, random);
  dwell_.assign(n, 0);
  for (const size_t junction : junction_points) {
    if (!random.Chance(options.stop_share)) continue;
    const Vector2d p = line[junction % line.size()].head<2>();
    const auto nearest =
        std::min_element(points_.begin(), points_.end(), [&](const Vector2d& a, const Vector2d& b) {
          return (a - p).squaredNorm() < (b - p).squaredNorm();
        });
    constexpr double kBefore = 5;  // metres from where the turn begins
    const size_t stop = (static_cast<size_t>(nearest - points_.begin()) + n -
                         static_cast<size_t>(kBefore / kStep)) %
                        n;
    speeds_[stop] = 0;
    dwell_[stop] = random.Uniform(0.8, 2.5);
  }
  // What lies ahead bounds the speed by braking, what lies behind by accelerating; twice round so
  // that it holds across the seam.
  for (size_t k = 2 * n; k-- > 0;) {
    const double ahead = speeds_[(k + 1) % n];
    speeds_[k % n] = std::min(speeds_[k % n], std::sqrt(ahead * ahead + 2 * kBraking * kStep));
  }
  for (size_t k = 0; k < 2 * n; ++k) {
    const double behind = speeds_[k % n];
    speeds_[(k + 1) % n] =
        std::min(speeds_[(k + 1) % n], std::sqrt(behind * behind + 2 * kAccelerating * kStep));
  }
  for (size_t i = 0; i < n; ++i) {
    arrivals_.push_back(duration_);
    duration_ += dwell_[i] + 2 * kStep / (speeds_[i] + speeds_[(i + 1) % n]);
  }
}

double Lap::length() const { return kStep * static_cast<double>(points_.size()); }

Lap::State Lap::At(double time) const {
  time -= duration_ * std::floor(time / duration_);
  const auto next = std::upper_bound(arrivals_.begin(), arrivals_.end(), time);
  const auto i = static_cast<size_t>(next - arrivals_.begin()) - 1;
  const double elapsed = time - arrivals_[i] - dwell_[i];
  const double station = kStep * static_cast<double>(i);
  if (elapsed <= 0) return {station, speeds_[i]};
  const double v0 = speeds_[i];
  const double v1 = speeds_[(i + 1) % speeds_.size()];
  const double acceleration = (v1 * v1 - v0 * v0) / (2 * kStep);
  const double advance =
      std::clamp(v0 * elapsed + 0.5 * acceleration * elapsed * elapsed, 0.0, kStep);
  return {std::fmod(station + advance, length()), std::max(0.0, v0 + acceleration * elapsed)};
}

double Lap::TimeAt(double station) const {
  const double x = (station - length() * std::floor(station / length())) / kStep;
  const size_t i = static_cast<size_t>(x) % points_.size();
  const double end = i + 1 < arrivals_.size() ? arrivals_[i + 1] : duration_;
  const double leaves = arrivals_[i] + dwell_[i];
  return leaves + (x - std::floor(x)) * (end - leaves);
}

double Lap::RoomOnRight(double station) const {
  const double wrapped = station - length() * std::floor(station / length());
  return room_[static_cast<size_t>(wrapped / kStep) % room_.size()];
}

Vector2d Lap::Point(double station, double left) const {
  const double wrapped = station - length() * std::floor(station / length());
  const double x = wrapped / kStep;
  const auto whole = static_cast<size_t>(x);
  const double t = x - static_cast<double>(whole);
  const size_t n = points_.size();
  const Vector2d& a = points_[whole % n];
  const Vector2d& b = points_[(whole + 1) % n];
  const Vector2d on_line = (1 - t) * a + t * b;
  if (left == 0) return on_line;
  // The normal changes with the direction over a metre, so that it turns steadily.
  const auto chord = [&](size_t i) -> Vector2d {
    return points_[(i + 2) % n] - points_[(i + n - 2) % n];
  };
  const Vector2d forward = ((1 - t) * chord(whole % n) + t * chord((whole + 1) % n)).normalized();
  return on_line + left * Vector2d(-forward.y(), forward.x());
}

RoadPlace Lap::PlaceAt(double station, const Lateral& left) const {
  const Vector2d front = Point(station + kHalfWheelbase, left.front);
  const Vector2d rear = Point(station - kHalfWheelbase, left.rear);
  return {Point(station, left.middle), (front - rear).normalized()};
}

RoadPose Lap::PoseAt(double station, const Lateral& left) const {
  constexpr double kHalfTrack = 0.8;  // metres
  RoadPose pose;
  static_cast<RoadPlace&>(pose) = PlaceAt(station, left);
  const Vector2d leftward(-pose.forward.y(), pose.forward.x());
  const auto height = [&](double forward, double to_left) {
    return plan_->Height(pose.position + forward * pose.forward + to_left * leftward);
  };
  pose.height = height(0, 0);
  pose.slope =
      std::atan2(height(kHalfWheelbase, 0) - height(-kHalfWheelbase, 0), 2 * kHalfWheelbase);
  pose.bank = std::atan2(height(0, kHalfTrack) - height(0, -kHalfTrack), 2 * kHalfTrack);
  return pose;
}

}  // namespace orb360::town
