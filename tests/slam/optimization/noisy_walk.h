#pragma once

#include <algorithm>

#include "slam/optimization/bundle_adjustment.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {

/// A walk that sees points from a few poses each, over a ground and with ranges and points that two
/// poses see, all with noise, and every twentieth observation wrong altogether. Three of its twelve
/// poses are fixed.
inline BundleProblem NoisyWalk(int seed) {
  RandomGeometry random(seed);
  BundleProblem problem;
  for (int i = 0; i < 12; ++i) {
    problem.world_from_camera.push_back({random.Rotation(0.3), {0.5 * i, 0.1 * i, 0.02 * i * i}});
    problem.pose_fixed.push_back(i == 0 || i == 5 || i == 11);
  }
  for (int p = 0; p < 300; ++p) {
    Eigen::Vector3d point = random.Point(2.0, 12.0) + Eigen::Vector3d(3, 0, 0);
    const bool is_ground = p < 60;
    if (is_ground) point.z() = -1.6;
    problem.points.push_back(point + random.Point(0.0, 0.05));
    for (int i = p % 8; i < p % 8 + 5; ++i) {
      const Eigen::Vector3d seen = problem.world_from_camera[i].Inverse() * point;
      const bool is_wrong = (5 * p + i) % 20 == 0;
      const double sigma = random.Uniform(0.001, 0.003);
      problem.observations.push_back(
          {i, p, random.Noisy(seen.normalized(), is_wrong ? 0.1 : sigma), sigma});
      if (p % 3 == 0) problem.ranges.push_back({i, p, seen.norm() * random.Uniform(0.8, 1.2), 0.1});
      if (is_ground) {
        const Eigen::Vector3d up(0, 0, 1);
        const double height = 1.6 + problem.world_from_camera[i].translation.z();
        problem.heights.push_back(
            {i, p, problem.world_from_camera[i].rotation.inverse() * up, height, 0.05});
      }
    }
  }
  RandomGeometry random_shared(seed + 1000);
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < std::min(12, i + 3); ++j) {
      const Eigen::Vector3d point = random_shared.Point(0.5, 3.0);
      BundleProblem::SharedPoint seen{
          .pose1 = i,
          .pose2 = j,
          .point1 = problem.world_from_camera[i].Inverse() * point + random_shared.Point(0.0, 0.02),
          .point2 = problem.world_from_camera[j].Inverse() * point,
          .sqrt_information = {}};
      for (double& value : seen.sqrt_information.reshaped()) {
        value = random_shared.Uniform(-50.0, 50.0);
      }
      problem.shared_points.push_back(seen);
    }
  }
  for (size_t i = 0; i < problem.world_from_camera.size(); ++i) {
    if (problem.pose_fixed[i]) continue;
    Rigid3& pose = problem.world_from_camera[i];
    pose = pose * Rigid3{random.Rotation(0.01), random.Point(0.0, 0.03)};
  }
  return problem;
}

}  // namespace orb360
