#include "apps/town/drive/carried_camera.h"

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

TEST(CarriedCamera, WithoutSwayingItIsLevelAtItsHeightAndLooksAhead) {
  const Carriage carriage{.height = 1.6, .speed = 1, .sway = 0};
  const WalkState state{{3, 4}, 0.7, 12};
  const Rigid3 pose = CarriedPose(carriage, {}, state, 5, Random(1), 2);
  EXPECT_NEAR((pose.translation - Eigen::Vector3d(3, 4, 6.6)).norm(), 0, 1e-9);
  // The camera looks along -X, and +Z is up.
  const Eigen::Vector3d ahead = pose.rotation * -Eigen::Vector3d::UnitX();
  EXPECT_NEAR((ahead - Eigen::Vector3d(std::cos(0.7), std::sin(0.7), 0)).norm(), 0, 1e-9);
  const Eigen::Vector3d up = pose.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR((up - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-9);
}

TEST(CarriedCamera, PitchRaisesItsNoseAndRollItsLeftSide) {
  const Carriage carriage{.sway = 0};
  const Mount mount{.height = {}, .pitch = 0.1, .roll = 0.2};
  const Rigid3 pose = CarriedPose(carriage, mount, {{0, 0}}, 0, Random(1), 0);
  EXPECT_NEAR((pose.rotation * -Eigen::Vector3d::UnitX()).z(), std::sin(0.1), 1e-9);
  EXPECT_GT((pose.rotation * -Eigen::Vector3d::UnitY()).z(), 0.15);  // left is -Y
}

TEST(CarriedCamera, IsARobotsOrAPersons) {
  int robots = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const Carriage carriage = DrawCarriage({}, 3, "the way", Random(seed));
    const bool is_robot = carriage.height < 1;
    robots += is_robot ? 1 : 0;
    EXPECT_GE(carriage.height, is_robot ? 0.3 : 1.2);
    EXPECT_LE(carriage.height, is_robot ? 0.8 : 2.2);
    EXPECT_EQ(carriage.sway < 0.11, is_robot);
  }
  EXPECT_GT(robots, 30);
  EXPECT_LT(robots, 90);
}

TEST(CarriedCamera, IsNoHigherThanThereIsRoom) {
  for (uint64_t seed = 0; seed < 40; ++seed)
    EXPECT_LE(DrawCarriage({}, 1.4, "the way", Random(seed)).height, 1.4);
  Mount mount;
  mount.height = 1.4;
  EXPECT_EQ(DrawCarriage(mount, 1.4, "the way", Random(1)).height, 1.4);
  mount.height = 1.5;
  EXPECT_THROW(DrawCarriage(mount, 1.4, "the way", Random(1)), UserError);
}

}  // namespace
}  // namespace orb360::town
