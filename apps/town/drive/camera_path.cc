#include "apps/town/drive/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "apps/town/image/random.h"
#include "slam/check.h"

namespace orb360::town {
namespace {

constexpr double kStep = 0.25;                // metres between the points of the driven line
constexpr double kLateralAcceleration = 2.2;  // metres per second squared, in bends
constexpr double kBraking = 1.6;              // metres per second squared
constexpr double kAccelerating = 1.3;

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

Vector2d LanePoint(const StreetPlan& plan, const Leg& leg, double station) {
  const StreetPoint p = plan.streets[leg.street].At(station);
  const double direction = leg.to > leg.from ? 1 : -1;
  const Vector2d right(direction * p.tangent.y(), -direction * p.tangent.x());
  return p.position + plan.streets[leg.street].LaneOffset(p.half_width) * right;
}

Vector2d LaneDirection(const StreetPlan& plan, const Leg& leg, double station) {
  return (leg.to > leg.from ? 1 : -1) * plan.streets[leg.street].At(station).tangent;
}

/// Points every kStep metres along a polyline, closed into a ring.
std::vector<Vector2d> Resample(const std::vector<Vector2d>& ring) {
  std::vector<Vector2d> result;
  double carried = 0;  // metres since the last point
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vector2d& a = ring[i];
    const Vector2d& b = ring[(i + 1) % ring.size()];
    const double length = (b - a).norm();
    if (length < 1e-9) continue;
    double s = kStep - carried;
    for (; s <= length; s += kStep) result.emplace_back(a + s / length * (b - a));
    carried = length - (s - kStep);
  }
  return result;
}

/// The driven line as a ring: lanes joined at the junctions by curves.
std::vector<Vector2d> DrivenLine(const StreetPlan& plan, std::vector<size_t>* junction_points) {
  constexpr double kApproach = 9.5;  // metres from the junction at which a turn begins and ends
  std::vector<Leg> legs;
  for (size_t i = 0; i < plan.tour.size(); ++i)
    legs.push_back(FindLeg(plan, plan.tour[i], plan.tour[(i + 1) % plan.tour.size()]));
  std::vector<Vector2d> ring;
  for (size_t i = 0; i < legs.size(); ++i) {
    const Leg& leg = legs[i];
    const Leg& next = legs[(i + 1) % legs.size()];
    const double direction = leg.to > leg.from ? 1 : -1;
    const double next_direction = next.to > next.from ? 1 : -1;
    const bool straight_on = leg.street == next.street;
    const double trim = straight_on ? 0 : kApproach;
    const bool came_straight = legs[(i + legs.size() - 1) % legs.size()].street == leg.street;
    const double begin = leg.from + direction * (came_straight ? 0 : kApproach);
    const double end = leg.to - direction * trim;
    for (double s = begin; direction * (end - s) > 0; s += direction * 0.5)
      ring.push_back(LanePoint(plan, leg, s));
    junction_points->push_back(ring.size());
    if (straight_on) continue;
    const double exit = next.from + next_direction * kApproach;
    const Vector2d p0 = LanePoint(plan, leg, end);
    const Vector2d p3 = LanePoint(plan, next, exit);
    const double reach = 0.45 * (p3 - p0).norm();
    const Vector2d p1 = p0 + reach * LaneDirection(plan, leg, end);
    const Vector2d p2 = p3 - reach * LaneDirection(plan, next, exit);
    for (int k = 0; k < 40; ++k) {
      const double t = k / 40.0;
      const double q = 1 - t;
      ring.emplace_back(q * q * q * p0 + 3 * q * q * t * p1 + 3 * q * t * t * p2 + t * t * t * p3);
    }
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

/// A sum of sinusoids of random phase with unit variance, frequencies in hertz: band-limited
/// noise.
class Shake {
 public:
  Shake(Random& random, double low, double high) {
    for (Wave& wave : waves_)
      wave = {2 * std::numbers::pi * random.Uniform(low, high), random.Uniform(0, 6.2831853)};
  }
  double At(double time) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.rate * time + wave.phase);
    return sum * std::sqrt(2.0 / waves_.size());
  }

 private:
  struct Wave {
    double rate;
    double phase;
  };
  std::array<Wave, 6> waves_;
};

/// The car's motion along the ring, which is closed: index i is at station i * kStep.
struct Ring {
  std::vector<Vector2d> points;
  std::vector<double> speed_limit;
  std::vector<size_t> stops;

  size_t Index(double station) const {
    return static_cast<size_t>(std::llround(station / kStep)) % points.size();
  }
  Vector2d At(double station) const {
    const double x = station / kStep;
    const auto whole = static_cast<size_t>(x);
    const double t = x - std::floor(x);
    const size_t n = points.size();
    return (1 - t) * points[whole % n] + t * points[(whole + 1) % n];
  }
};

Ring MakeRing(const StreetPlan& plan, const DriveOptions& options, Random& random) {
  std::vector<size_t> junction_points;
  const std::vector<Vector2d> line = DrivenLine(plan, &junction_points);
  Ring ring;
  ring.points = SmoothRing(Resample(line), 7);
  const size_t n = ring.points.size();
  // What the driver would like to do, changing every 30 m or so.
  std::vector<double> wish(n);
  double target = options.maximum_speed;
  for (size_t i = 0; i < n; ++i) {
    if (i % static_cast<size_t>(30 / kStep) == 0)
      target = random.Uniform(options.minimum_speed, options.maximum_speed);
    wish[i] = target;
  }
  wish = SmoothRing(wish, static_cast<int>(6 / kStep));
  for (size_t i = 0; i < n; ++i) {
    const size_t reach = 8;
    const Vector2d& a = ring.points[(i + n - reach) % n];
    const Vector2d& b = ring.points[i];
    const Vector2d& c = ring.points[(i + reach) % n];
    const Vector2d ab = b - a;
    const Vector2d bc = c - b;
    const double turn = std::abs(std::atan2(ab.x() * bc.y() - ab.y() * bc.x(), ab.dot(bc)));
    const double curvature = turn / (0.5 * (ab.norm() + bc.norm()));
    wish[i] = std::min(wish[i], std::sqrt(kLateralAcceleration / std::max(curvature, 1e-4)));
  }
  for (const size_t junction : junction_points) {
    if (!random.Chance(0.3)) continue;
    // Stop before the turn begins: find the nearest point of the resampled ring.
    const Vector2d& p = line[junction % line.size()];
    size_t nearest = 0;
    for (size_t i = 1; i < n; ++i) {
      if ((ring.points[i] - p).squaredNorm() < (ring.points[nearest] - p).squaredNorm())
        nearest = i;
    }
    ring.stops.push_back((nearest + n - static_cast<size_t>(5 / kStep)) % n);
  }
  for (const size_t stop : ring.stops) wish[stop] = 0;
  // Limits ahead bound the speed here; twice round so that it holds across the seam.
  for (size_t k = 2 * n; k-- > 0;) {
    const double ahead = wish[(k + 1) % n];
    wish[k % n] = std::min(wish[k % n], std::sqrt(ahead * ahead + 2 * kBraking * kStep));
  }
  ring.speed_limit = std::move(wish);
  return ring;
}

}  // namespace

std::vector<Rigid3> DriveTour(const StreetPlan& plan, const DriveOptions& options) {
  Random random(options.seed);
  const Ring ring = MakeRing(plan, options, random);
  const double length = kStep * static_cast<double>(ring.points.size());
  const Shake pitch_shake(random, 0.8, 5);
  const Shake roll_shake(random, 0.6, 4);
  const Shake yaw_shake(random, 0.1, 0.8);
  const Shake heave(random, 0.8, 6);
  const double dt = 1 / options.fps;
  double station = random.Uniform(0, length);
  double speed = ring.speed_limit[ring.Index(station)];
  double waiting = 0;  // seconds left at a stop
  std::optional<size_t> last_stop;
  double pitch = 0;
  double roll = 0;
  std::vector<Rigid3> poses;
  for (int frame = 0; frame < options.frames; ++frame) {
    const double time = frame * dt;
    const auto height = [&](const Vector2d& p) { return plan.Height(p); };
    const Vector2d position = ring.At(station);
    const Vector2d ahead = ring.At(station + 1.4);  // half a wheelbase
    const Vector2d behind = ring.At(station + length - 1.4);
    const Vector2d forward = (ahead - behind).normalized();
    const Vector2d left(-forward.y(), forward.x());
    const double slope = std::atan2(height(ahead) - height(behind), (ahead - behind).norm());
    const double bank =
        std::atan2(height(position + 0.8 * left) - height(position - 0.8 * left), 1.6);

    const double limit = ring.speed_limit[ring.Index(station)];
    const double previous = speed;
    speed = std::clamp(limit, speed - 1.3 * kBraking * dt, speed + kAccelerating * dt);
    if (waiting > 0) {
      waiting -= dt;
      speed = 0;
    } else {
      for (const size_t stop : ring.stops) {
        double to_stop =
            std::fmod(kStep * static_cast<double>(stop) - station + 2 * length, length);
        if (to_stop > 0.5 * length) to_stop -= length;
        if (last_stop != stop && std::abs(to_stop) < 0.4) {
          last_stop = stop;
          waiting = random.Uniform(0.8, 2.5);
        } else if (last_stop == stop && std::abs(to_stop) < 3) {
          speed = std::min(previous + kAccelerating * dt, options.maximum_speed);  // drive off
        } else if (last_stop == stop) {
          last_stop.reset();
        }
      }
      speed = std::max(speed, 0.3);  // creep up to a stop instead of never reaching it
    }
    const double acceleration = (speed - previous) / dt;
    // The body answers acceleration with a lag, and shakes more the faster it goes.
    pitch += 0.12 * (0.006 * acceleration - pitch);
    const Vector2d further = (ring.At(station + 2.8) - position).normalized();
    const double turn_rate = speed * (forward.x() * further.y() - forward.y() * further.x()) / 1.4;
    roll += 0.12 * (0.006 * turn_rate * speed - roll);
    const double shaking = std::min(1.0, speed / options.maximum_speed);
    const double yaw = std::atan2(forward.y(), forward.x()) + 0.002 * shaking * yaw_shake.At(time);
    const double nose_up = slope + pitch + 0.0022 * shaking * pitch_shake.At(time);
    const double right_down = bank + roll + 0.0025 * shaking * roll_shake.At(time);

    // Level camera looking along world +x: camera (-X, +Y, +Z) = world (+x, -y, +z).
    const Eigen::Quaterniond level(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
    Rigid3 pose;
    pose.rotation = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(-nose_up, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(right_down, Eigen::Vector3d::UnitX()) * level)
                        .normalized();
    pose.translation << position,
        height(position) + options.camera_height + 0.004 * shaking * heave.At(time);
    poses.push_back(pose);
    station = std::fmod(station + speed * dt, length);
  }
  return poses;
}

}  // namespace orb360::town
