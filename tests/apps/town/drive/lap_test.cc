#include "apps/town/drive/lap.h"

#include <cmath>

#include <gtest/gtest.h>

#include "apps/town/drive/camera_motion.h"

namespace orb360::town {
namespace {

StreetPlan Plan() {
  PlanOptions options;
  options.seed = 4;
  return PlanStreets(options);
}

TEST(Lap, RepeatsAfterItsDuration) {
  const StreetPlan plan = Plan();
  const Lap lap(plan, plan.tour, {.seed = 1});
  for (double t = -20; t < 20; t += 3.7) {
    EXPECT_NEAR(lap.At(t).station, lap.At(t + lap.duration()).station, 1e-6);
  }
}

TEST(Lap, KeepsToTheSpeedAndTheAccelerationsOfATown) {
  const StreetPlan plan = Plan();
  const Lap lap(plan, plan.tour, {.seed = 1});
  constexpr double kStep = 0.05;
  double standing = 0;
  for (double t = 0; t < lap.duration(); t += kStep) {
    const Lap::State a = lap.At(t);
    const Lap::State b = lap.At(t + kStep);
    double advance = b.station - a.station;
    if (advance < -1) advance += lap.length();
    EXPECT_GE(advance, 0);
    EXPECT_LE(advance, 12.01 * kStep);
    EXPECT_NEAR(advance / kStep, 0.5 * (a.speed + b.speed), 0.15);
    EXPECT_LT(std::abs(b.speed - a.speed) / kStep, 2.9);
    if (a.speed == 0) standing += kStep;
  }
  EXPECT_GT(standing, 0.5) << "no stop on the whole lap";
}

TEST(Lap, StaysOnTheCarriageway) {
  const StreetPlan plan = Plan();
  const Lap lap(plan, plan.tour, {.seed = 1});
  for (double s = 0; s < lap.length(); s += 0.5)
    EXPECT_LT(plan.DistanceToRoad(lap.PoseAt(s).position), -0.8) << s;
}

TEST(CameraPose, LooksAlongThePathFromItsHeightAboveTheRoad) {
  const StreetPlan plan = Plan();
  const Lap lap(plan, plan.tour, {.seed = 1});
  const CameraMotionOptions options{.seed = 9, .height = 2.1};
  for (double t = 0; t < lap.duration(); t += 0.7) {
    const Rigid3 pose = CameraPose(lap, options, t);
    const Rigid3 next = CameraPose(lap, options, t + 0.02);
    EXPECT_NEAR(pose.translation.z() - plan.Height(pose.translation.head<2>()), 2.1, 0.03);
    const Eigen::Vector3d step = next.translation - pose.translation;
    const Eigen::Vector3d forward = pose.rotation * -Eigen::Vector3d::UnitX();
    if (step.norm() > 0.05) {
      EXPECT_GT(step.normalized().dot(forward), 0.97) << t;
    }
    EXPECT_GT((pose.rotation * Eigen::Vector3d::UnitZ()).z(), 0.98);
  }
}

TEST(CameraPose, WithoutShakingFollowsTheRoadOnly) {
  const StreetPlan plan = Plan();
  const Lap lap(plan, plan.tour, {.seed = 1});
  const Rigid3 a = CameraPose(lap, {.seed = 1, .shaking = 0}, 12.3);
  const Rigid3 b = CameraPose(lap, {.seed = 2, .shaking = 0}, 12.3);
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

}  // namespace
}  // namespace orb360::town
