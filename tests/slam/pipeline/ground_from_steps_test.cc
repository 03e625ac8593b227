#include "slam/pipeline/ground_from_steps.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "slam/pipeline/ground_steps.h"
#include "tests/slam/pipeline/ground_drive.h"

namespace orb360 {
namespace {

TEST(GroundFromSteps, FindsHeightAndNormalInTheMapsUnit) {
  Map map = Drive(6, 0.25, Scaled(Asphalt(4)));
  for (KeyframeId id = 1; id < 6; ++id) MeasureGroundSteps(id, std::nullopt, {}, &map);
  const std::vector<KeyframeId> all = {1, 2, 3, 4, 5};
  const std::optional<KnownGround> ground = GroundFromSteps(map, all);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->camera_height / (0.25 * kHeight), 1.0, 0.005);
  EXPECT_LT(std::acos(ground->up.z()), 0.02);
  EXPECT_FALSE(ground->is_rough);
}

TEST(GroundFromSteps, HasTheNewestUnitWhereThatDriftsButTheStepsAddUp) {
  Map map = Drive(6, 1.0, Scaled(Asphalt(5)));
  for (KeyframeId id = 1; id < 6; ++id) MeasureGroundSteps(id, std::nullopt, {}, &map);
  // Far landmarks have let each step shrink by a third.
  Eigen::Vector3d place = TruePose(0).translation;
  for (KeyframeId id = 1; id < 6; ++id) {
    place += std::pow(0.67, id) * (TruePose(id).translation - TruePose(id - 1).translation);
    map.keyframe(id).world_from_camera.translation = place;
  }
  const std::vector<KeyframeId> all = {1, 2, 3, 4, 5};
  const std::optional<KnownGround> ground = GroundFromSteps(map, all);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->camera_height / (std::pow(0.67, 5) * kHeight), 1.0, 0.01);
  EXPECT_LT(std::acos(ground->up.z()), 0.02);
  // The newest one has to add up.
  map.keyframe(5).ground_steps.front().ratio *= 1.2;
  EXPECT_FALSE(GroundFromSteps(map, all));
}

TEST(GroundFromSteps, IsEmptyWhereTheHeightsDisagree) {
  Map map = Drive(6, 1.0, Scaled(Asphalt(5)));
  for (KeyframeId id = 1; id < 6; ++id) {
    MeasureGroundSteps(id, std::nullopt, {}, &map);
    map.keyframe(id).ground_steps.resize(1);
  }
  map.keyframe(1).ground_steps.clear();
  map.keyframe(2).ground_steps.front().ratio *= 1.3;
  const std::vector<KeyframeId> all = {1, 2, 3, 4, 5};
  EXPECT_FALSE(GroundFromSteps(map, all));
}

TEST(AgreesWithSteps, RefusesAPlaneAtAnotherHeight) {
  Map map = Drive(4, 0.3, Scaled(Asphalt(10)));
  for (const KeyframeId id : {1, 2, 3}) MeasureGroundSteps(id, std::nullopt, {}, &map);
  const std::vector<KeyframeId> all = map.KeyframeIds();
  const KnownGround right{.up = Eigen::Vector3d::UnitZ(), .camera_height = 0.3 * kHeight};
  const KnownGround wrong{.up = Eigen::Vector3d::UnitZ(), .camera_height = kHeight};
  EXPECT_TRUE(AgreesWithSteps(right, map, all));
  EXPECT_FALSE(AgreesWithSteps(wrong, map, all));
  for (const KeyframeId id : all) map.keyframe(id).ground_steps.clear();
  EXPECT_TRUE(AgreesWithSteps(wrong, map, all));
}

}  // namespace
}  // namespace orb360
