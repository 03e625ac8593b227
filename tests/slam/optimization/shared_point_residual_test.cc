#include "slam/optimization/shared_point_residual.h"

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

BundleProblem::SharedPoint RandomPoint(const Rigid3& pose1, const Rigid3& pose2,
                                       RandomGeometry* random) {
  const Eigen::Vector3d point = random->Point(1.0, 4.0);
  Eigen::Matrix<double, 2, 3> sqrt_information;
  for (double& value : sqrt_information.reshaped()) value = random->Normal(10.0);
  return {.pose1 = 0,
          .pose2 = 1,
          .point1 = pose1 * point,
          .point2 = pose2 * point,
          .sqrt_information = sqrt_information};
}

TEST(SharedPointResidual, IsZeroWhereBothCamerasSeeThePointInOnePlace) {
  RandomGeometry random(1);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 pose1 = random.Transform();
    const Rigid3 pose2 = random.Transform();
    const BundleProblem::SharedPoint shared = RandomPoint(pose1, pose2, &random);
    EXPECT_LT(SharedPointResidual(shared, pose1, pose2, nullptr, nullptr).norm(), 1e-12);
  }
}

TEST(SharedPointResidual, JacobiansAreThoseOfFiniteDifferences) {
  RandomGeometry random(2);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 pose1 = random.Transform();
    const Rigid3 pose2 = random.Transform();
    // The poses are not those in which the point was seen.
    const BundleProblem::SharedPoint shared =
        RandomPoint(pose1 * Rigid3{random.Rotation(0.2), random.Point(0.0, 0.2)}, pose2, &random);
    SharedPointJacobian by_pose1;
    SharedPointJacobian by_pose2;
    SharedPointResidual(shared, pose1, pose2, &by_pose1, &by_pose2);
    constexpr double kDelta = 1e-6;
    for (int k = 0; k < 6; ++k) {
      const auto moved = [&](const Rigid3& pose, double delta) {
        Eigen::Matrix<double, 6, 1> step = Eigen::Matrix<double, 6, 1>::Zero();
        step[k] = delta;
        return Rigid3{ExpSo3(step.head<3>()), step.tail<3>()} * pose;
      };
      const auto residual = [&](double delta1, double delta2) {
        return SharedPointResidual(shared, moved(pose1, delta1), moved(pose2, delta2), nullptr,
                                   nullptr);
      };
      EXPECT_LT(
          ((residual(kDelta, 0) - residual(-kDelta, 0)) / (2 * kDelta) - by_pose1.col(k)).norm(),
          1e-6 * (1 + by_pose1.norm()));
      EXPECT_LT(
          ((residual(0, kDelta) - residual(0, -kDelta)) / (2 * kDelta) - by_pose2.col(k)).norm(),
          1e-6 * (1 + by_pose2.norm()));
    }
  }
}

}  // namespace
}  // namespace orb360
