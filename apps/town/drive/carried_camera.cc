#include "apps/town/drive/carried_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// A slow motion of about unit size at a time in seconds.
double Drift(Random random, double time) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const double rate = 2 * std::numbers::pi * random.Uniform(0.08, 0.45);
    sum += std::sin(rate * time + random.Uniform(0, 2 * std::numbers::pi));
  }
  return 0.5 * sum;
}

}  // namespace

Carriage DrawCarriage(const Mount& mount, double highest, std::string_view place, Random random) {
  Carriage carriage;
  const bool is_robot = random.Chance(0.3);
  carriage.height = is_robot ? random.Uniform(0.3, 0.8) : random.Uniform(1.2, 2.2);
  carriage.speed = is_robot ? random.Uniform(0.5, 1) : random.Uniform(0.7, 1.5);
  carriage.sway = (is_robot ? 0.1 : random.Uniform(0.4, 1.2)) * mount.shaking;
  carriage.height = mount.height.value_or(std::min(carriage.height, highest));
  if (carriage.height <= highest) return carriage;
  std::ostringstream message;
  message << "the camera is " << carriage.height << " m high, but " << place << " has room for "
          << std::floor(100 * highest) / 100 << " m: lower it with --camera-height";
  throw UserError(message.str());
}

Rigid3 CarriedPose(const Carriage& carriage, const Mount& mount, const WalkState& state,
                   double ground, const Random& random, double seconds) {
  const double sway = carriage.sway;
  constexpr double kStride = 0.68;  // metres a step
  const double phase = 2 * std::numbers::pi * state.distance / kStride;
  const double yaw =
      state.heading + sway * (0.12 * Drift(random.Fork(1), seconds) + 0.02 * std::sin(0.5 * phase));
  const double nose_up = sway * (0.02 * Drift(random.Fork(2), seconds) + 0.008 * std::sin(phase));
  const double left_up =
      sway * (0.02 * Drift(random.Fork(3), seconds) + 0.014 * std::sin(0.5 * phase));
  const double aside = 0.018 * sway * std::sin(0.5 * phase);  // metres
  const double heave = sway * (0.014 * std::cos(phase) + 0.008 * Drift(random.Fork(4), seconds));
  // A level camera that looks along world +x: camera (-X, +Y, +Z) is world (+x, -y, +z).
  const Eigen::Quaterniond level(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond body =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(-nose_up - mount.pitch, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(left_up + mount.roll, Eigen::Vector3d::UnitX());
  Rigid3 pose;
  pose.rotation = (body * level).normalized();
  pose.translation << state.position, ground + carriage.height + heave;
  pose.translation.head<2>() +=
      aside * Eigen::Vector2d(-std::sin(state.heading), std::cos(state.heading));
  return pose;
}

}  // namespace orb360::town
