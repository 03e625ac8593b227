#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "slam/scale/timed_path.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/scale/position_fix.h>

namespace orb360 {

/// Errors of a simulated receiver.
struct ReceiverNoise {
  double sigma = 3.0;              ///< In each direction, metres.
  double correlated_fraction = 0;  ///< Of the variance, by a first-order Gauss-Markov process.
  double correlation_time = 60;    ///< Seconds.
};

/// A drive of 1.2 km through a town at 10 m/s, two points a second: straight streets, bends of a
/// block's corner, a hill of 15 m.
inline std::vector<PathPoint> TownDrive(double duration = 120) {
  std::vector<PathPoint> path;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double heading = 0;
  constexpr double kStep = 0.5;
  for (double t = 0; t <= duration; t += kStep) {
    path.push_back({t, position + Eigen::Vector3d(0, 0, 15 * std::sin(t / 40))});
    const double speed = 10 + 3 * std::sin(t / 9);
    // A bend of 90 degrees within 6 s, every 20 s, mostly to the left.
    const double turn = std::fmod(t, 20) < 6 ? std::numbers::pi / 12 : 0;
    heading += kStep * turn * (std::fmod(t, 100) < 60 ? 1 : -1);
    position += kStep * speed * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0);
  }
  return path;
}

/// Fixes of a path each `period` seconds, transformed, on a clock that is `offset` behind that of
/// the path.
inline std::vector<PositionFix> Receive(const std::vector<PathPoint>& path,
                                        const Similarity3& local_from_path,
                                        const ReceiverNoise& noise, double period, double offset,
                                        RandomGeometry* random) {
  std::vector<PositionFix> fixes;
  Eigen::Vector3d state;
  for (double& element : state) element = random->Normal(1);
  const double kept = std::exp(-period / noise.correlation_time);
  for (double t = path.front().timestamp; t <= path.back().timestamp; t += period) {
    const auto at = Interpolate(path, t, 10);
    Eigen::Vector3d error;
    for (int axis = 0; axis < 3; ++axis) {
      state[axis] = kept * state[axis] + random->Normal(std::sqrt(1 - kept * kept));
      error[axis] = noise.sigma * (std::sqrt(noise.correlated_fraction) * state[axis] +
                                   random->Normal(std::sqrt(1 - noise.correlated_fraction)));
    }
    error.z() *= 2;
    if (at) {
      fixes.push_back(
          {t - offset, local_from_path * at->position + error, noise.sigma, 2 * noise.sigma});
    }
  }
  return fixes;
}

}  // namespace orb360
