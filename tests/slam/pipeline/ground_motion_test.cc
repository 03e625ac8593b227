#include "slam/pipeline/ground_motion.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr double kPeriod = 0.1;  // s
const KnownGround kGround{.up = Eigen::Vector3d::UnitZ(), .camera_height = 1.5};

// A drive on an arc: forward is the camera's -x; each step is `turn` radians long at this radius.
constexpr double kRadius = 20.0;
Rigid3 OnArc(double angle) {
  const Eigen::Quaterniond yaw = ExpSo3(Eigen::Vector3d(0, 0, angle));
  return {yaw, yaw * Eigen::Vector3d(0, -kRadius, 0)};
}

// Keyframes on the arc with steps that are `factors` times as long as they are.
Map Drive(double turn, const std::vector<double>& factors) {
  Map map;
  for (size_t i = 0; i < factors.size(); ++i) {
    const Rigid3 pose = OnArc(turn * static_cast<double>(i));
    const KeyframeId id = map.AddKeyframe(static_cast<int>(i), kPeriod * static_cast<double>(i),
                                          pose, std::make_shared<Features>());
    if (i == 0) continue;
    const Eigen::Vector3d step =
        pose.rotation.conjugate() * (pose.translation - map.PoseOf(id - 1).translation);
    map.keyframe(id).ground_steps.push_back(
        {.keyframe = id - 1,
         .ratio = factors[i] * step.norm() / kGround.camera_height,
         .sigma = 0.003,
         .direction2 = step.normalized(),
         .up = Eigen::Vector3d::UnitZ()});
  }
  return map;
}

// Error of a predicted position in standard deviations.
double Sigmas(const PositionPrior& prior, const Eigen::Vector3d& truth) {
  return (prior.sqrt_information * (truth - prior.position)).norm();
}

TEST(GroundMotion, PredictsAnArc) {
  constexpr double kTurn = 0.04;
  const Map map = Drive(kTurn, std::vector<double>(6, 1.0));
  const auto motion = FindGroundMotion(map, 5, kGround);
  ASSERT_TRUE(motion.has_value());
  EXPECT_NEAR(motion->velocity.norm(), kTurn * kRadius / kPeriod, 0.01);
  const Rigid3 truth = OnArc(kTurn * 8);
  const PositionPrior prior = PredictPosition(*motion, 0.8, truth.rotation).value();
  const double distance = 3 * kTurn * kRadius;
  EXPECT_LT((prior.position - truth.translation).norm(), 0.03 * distance);
  EXPECT_LT(Sigmas(prior, truth.translation), 1.5);
  // The standard deviation is 2 % of the distance where the motion does not change.
  EXPECT_NEAR(prior.sqrt_information.inverse().norm(), std::sqrt(3.0) * 0.02 * distance,
              0.001 * distance);
}

TEST(GroundMotion, IsUncertainWhereTheSpeedChanges) {
  const Map map = Drive(0.02, {1.0, 0.8, 1.2, 0.8, 1.2, 0.8, 1.2});
  const auto motion = FindGroundMotion(map, 6, kGround);
  ASSERT_TRUE(motion.has_value());
  // ln(1.2 / 0.8) from step to step.
  EXPECT_NEAR(std::sqrt(motion->speed_variance * kPeriod), std::log(1.5), 0.01);
  const PositionPrior prior = PredictPosition(*motion, 0.7, OnArc(0.14).rotation).value();
  EXPECT_LT(Sigmas(prior, OnArc(0.14).translation), 1.0);
}

TEST(GroundMotion, PredictsNothingForATimeThatIsNotLater) {
  const auto motion = FindGroundMotion(Drive(0.02, std::vector<double>(6, 1.0)), 5, kGround);
  ASSERT_TRUE(motion.has_value());
  EXPECT_FALSE(PredictPosition(*motion, motion->timestamp, OnArc(0.1).rotation));
  EXPECT_FALSE(PredictPosition(*motion, motion->timestamp - 1, OnArc(0.1).rotation));
}

TEST(GroundMotion, IsEmptyWithoutEnoughSteps) {
  EXPECT_FALSE(FindGroundMotion(Drive(0.02, {1.0, 1.0, 1.0}), 2, kGround).has_value());
  Map map = Drive(0.02, std::vector<double>(8, 1.0));
  map.keyframe(7).ground_steps.clear();
  EXPECT_FALSE(FindGroundMotion(map, 7, kGround).has_value());
  EXPECT_TRUE(FindGroundMotion(map, 6, kGround).has_value());
}

}  // namespace
}  // namespace orb360
