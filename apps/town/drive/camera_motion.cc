#include "apps/town/drive/camera_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

/// Band-limited noise of unit variance: sinusoids of random phase, frequencies in hertz.
class Shake {
 public:
  Shake(Random random, double low, double high) {
    for (Wave& wave : waves_) {
      wave.rate = 2 * std::numbers::pi * random.Uniform(low, high);
      wave.phase = random.Uniform(0, 2 * std::numbers::pi);
    }
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

double Heading(const RoadPose& pose) { return std::atan2(pose.forward.y(), pose.forward.x()); }

}  // namespace

Rigid3 CameraPose(const Ride& ride, const CameraMotionOptions& options, double time) {
  const Random random(options.seed);
  const double speed = ride.SpeedAt(time);
  const RoadPose road = ride.PoseAt(time);
  // The body leans by 0.006 rad for each m/s² of the acceleration, averaged over this time.
  constexpr double kMemory = 0.6;  // seconds
  constexpr double kLean = 0.006;  // radians per metre per second squared
  const double acceleration = (speed - ride.SpeedAt(time - kMemory)) / kMemory;
  const double turn =
      std::remainder(Heading(road) - Heading(ride.PoseAt(time - kMemory)), 2 * std::numbers::pi);
  const double lateral = speed * turn / kMemory;  // to the left
  // Vibration grows with speed and is full at 10 m/s.
  const double shaking = options.shaking * std::min(1.0, speed / 10);
  const double yaw = Heading(road) + 0.002 * shaking * Shake(random.Fork(1), 0.1, 0.8).At(time);
  const double nose_up = road.slope + options.shaking * kLean * acceleration +
                         0.0022 * shaking * Shake(random.Fork(2), 0.8, 5).At(time);
  const double left_up = road.bank + options.shaking * kLean * lateral +
                         0.0025 * shaking * Shake(random.Fork(3), 0.6, 4).At(time);
  const double heave = 0.004 * shaking * Shake(random.Fork(4), 0.8, 6).At(time);  // metres
  // A level camera that looks along world +x: camera (-X, +Y, +Z) is world (+x, -y, +z).
  const Eigen::Quaterniond level(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const auto turned = [&](double nose, double left) -> Eigen::Quaterniond {
    return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(-nose, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(left, Eigen::Vector3d::UnitX());
  };
  const Eigen::Vector3d up = turned(road.slope, road.bank) * Eigen::Vector3d::UnitZ();
  Rigid3 pose;
  pose.rotation =
      (turned(nose_up, left_up) * Eigen::AngleAxisd(-options.pitch, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(options.roll, Eigen::Vector3d::UnitX()) * level)
          .normalized();
  pose.translation << road.position, road.height;
  pose.translation += (options.height + heave) * up;
  return pose;
}

}  // namespace orb360::town
