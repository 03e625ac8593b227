#include "apps/town/drive/lap.h"

#include <algorithm>
#include <cmath>

#include "apps/town/drive/driven_line.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

constexpr double kStep = 0.25;                // metres between the points of the driven line
constexpr double kLateralAcceleration = 4.0;  // metres per second squared, in bends
constexpr double kBraking = 2.8;              // metres per second squared
constexpr double kAccelerating = 2.4;

/// Returns points every kStep metres along a polyline that is closed into a ring.
std::vector<LinePoint> Resample(const std::vector<LinePoint>& ring) {
  std::vector<LinePoint> result;
  double carried = 0;  // metres since the last point
  for (size_t i = 0; i < ring.size(); ++i) {
    const LinePoint& a = ring[i];
    const LinePoint& b = ring[(i + 1) % ring.size()];
    const double length = (b - a).head<2>().norm();
    if (length < 1e-9) continue;
    double s = kStep - carried;
    while (s <= length) {
      result.emplace_back(a + s / length * (b - a));
      s += kStep;
    }
    carried = length - (s - kStep);
  }
  return result;
}

/// Returns the circular moving average over 2 * radius + 1 values.
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

/// Returns the speeds that drivers want, which change every 30 m or so, within the limits of the
/// bends.
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
    if (!random.Chance(options.stop_fraction)) continue;
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
  // Braking for what lies ahead and accelerating from what lies behind bound the speed. Two passes
  // round the ring make this hold across its seam.
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
  Vector2d on_line = (1 - t) * a + t * b;
  if (left == 0) return on_line;
  // The normal follows the direction averaged over a metre, so that it turns steadily.
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
