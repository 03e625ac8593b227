#include "apps/town/drive/camera_motion.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

/// A camera without shaking, on a car that stands on its own at the lap's start.
Rigid3 PoseWith(const CameraMotionOptions& options, double time = 3) {
  PlanOptions plan_options;
  plan_options.seed = 4;
  static const StreetPlan plan = PlanStreets(plan_options);
  static const Lap lap(plan, plan.tour, {.seed = 1});
  return CameraPose(lap, options, time);
}

TEST(CameraPose, StandsUprightOnASlopingRoad) {
  const Rigid3 low = PoseWith({.height = 1, .shaking = 0});
  const Rigid3 high = PoseWith({.height = 2.5, .shaking = 0});
  const Eigen::Vector3d up = low.rotation * Eigen::Vector3d::UnitZ();
  ASSERT_GT(std::acos(up.z()), 0.02) << "the road is level there";
  EXPECT_TRUE((high.translation - low.translation).isApprox(1.5 * up, 1e-9));
}

TEST(CameraPose, PitchRaisesWhatIsAheadOfTheCar) {
  // The camera looks along -X: with its nose up by an angle, that axis climbs by the angle in the
  // frame of the untilted camera, and the sideways axis stays.
  constexpr double kPitch = 0.3;
  const Rigid3 level = PoseWith({.shaking = 0});
  const Rigid3 tilted = PoseWith({.pitch = kPitch, .shaking = 0});
  const Eigen::Quaterniond turn = level.rotation.conjugate() * tilted.rotation;
  const Eigen::Vector3d forward = turn * -Eigen::Vector3d::UnitX();
  EXPECT_NEAR(forward.x(), -std::cos(kPitch), 1e-12);
  EXPECT_NEAR(forward.z(), std::sin(kPitch), 1e-12);
  EXPECT_NEAR((turn * Eigen::Vector3d::UnitY()).y(), 1, 1e-12);
}

TEST(CameraPose, RollRaisesTheLeftSide) {
  constexpr double kRoll = 0.2;
  const Rigid3 level = PoseWith({.shaking = 0});
  const Rigid3 tilted = PoseWith({.roll = kRoll, .shaking = 0});
  const Eigen::Quaterniond turn = level.rotation.conjugate() * tilted.rotation;
  const Eigen::Vector3d left = turn * -Eigen::Vector3d::UnitY();
  EXPECT_NEAR(left.y(), -std::cos(kRoll), 1e-12);
  EXPECT_NEAR(left.z(), std::sin(kRoll), 1e-12);
  EXPECT_NEAR((turn * Eigen::Vector3d::UnitX()).x(), 1, 1e-12);
}

TEST(CameraPose, ShakingMovesTheCameraByCentimetresAtMost) {
  for (double time = 0; time < 20; time += 0.37) {
    const Rigid3 still = PoseWith({.shaking = 0}, time);
    const Rigid3 shaken = PoseWith({.shaking = 1}, time);
    EXPECT_LT((still.translation - shaken.translation).norm(), 0.03);
    EXPECT_LT(still.rotation.angularDistance(shaken.rotation), 0.06);
  }
}

}  // namespace
}  // namespace orb360::town
