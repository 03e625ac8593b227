#include "slam/evaluation/revisit.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

// Straight from corner to corner, a metre and a tenth of a second from pose to pose; the camera
// looks where it goes.
std::vector<StampedPose> Drive(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<StampedPose> poses;
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d way = corners[i + 1] - corners[i];
    // Forward is -x.
    const double yaw = std::atan2(-way.y(), -way.x());
    const int steps = static_cast<int>(std::lround(way.norm()));
    for (int s = 0; s < steps; ++s) {
      const Eigen::Vector2d at = corners[i] + s / way.norm() * way;
      poses.push_back({0.1 * static_cast<double>(poses.size()),
                       {Eigen::Quaterniond(ExpSo3({0, 0, yaw})), {at.x(), at.y(), 0}}});
    }
  }
  return poses;
}

using Direction = TrueRevisit::Direction;

TEST(Revisit, OfASquareIsWhereItsFirstSideIsDrivenAgain) {
  const auto revisits = FindRevisits(Drive({{0, 0}, {40, 0}, {40, 40}, {0, 40}, {0, 0}, {20, 0}}));
  ASSERT_EQ(revisits.size(), 1u);
  // From 5 m before the corner on, after 160 m.
  EXPECT_NEAR(revisits[0].begin, 15.5, 0.15);
  EXPECT_NEAR(revisits[0].end, 17.9, 0.01);
  EXPECT_NEAR(revisits[0].length, 24, 1.5);
  EXPECT_EQ(revisits[0].direction, Direction::kSame);
}

TEST(Revisit, TellsOppositeDirectionAndCrossings) {
  // There and back along one street by way of another, which crosses it.
  const auto back = FindRevisits(Drive({{0, 0}, {100, 0}, {100, 30}, {104, 30}, {104, 0}, {0, 0}}));
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].direction, Direction::kOpposite);
  const auto across = FindRevisits(Drive({{0, 0}, {100, 0}, {100, 50}, {50, 50}, {50, -50}}));
  ASSERT_EQ(across.size(), 1u);
  EXPECT_EQ(across[0].direction, Direction::kAcross);
  EXPECT_NEAR(across[0].length, 8, 1.5);
}

TEST(Revisit, IsNoneWhereTheCameraStandsOrTurnsRound) {
  EXPECT_TRUE(FindRevisits(Drive({{0, 0}, {100, 0}})).empty());
  // A turn at once is no return: less than 50 m lie between.
  EXPECT_TRUE(FindRevisits(Drive({{0, 0}, {100, 0}, {100, 4}, {85, 4}})).empty());
  EXPECT_TRUE(FindRevisits({}).empty());
}

TEST(Revisit, IsClosedByALoopThatIsRightAndInTime) {
  const auto truth = Drive({{0, 0}, {40, 0}, {40, 40}, {0, 40}, {0, 0}, {20, 0}});
  const auto compare = [&](std::vector<LoopTimes> loops) { return CompareLoops(truth, loops); };
  EXPECT_EQ(compare({}).revisits, 1);
  EXPECT_EQ(compare({}).closed, 0);
  EXPECT_EQ(compare({{16.5, 0.4}}).closed, 1);
  EXPECT_EQ(compare({{16.5, 0.4}}).wrong, 0);
  // On the other side of the square.
  EXPECT_EQ(compare({{16.5, 8.0}}).closed, 0);
  EXPECT_EQ(compare({{16.5, 8.0}, {16.6, 0.4}}).wrong, 1);
  // Recognised 9 m before the corner.
  EXPECT_EQ(compare({{15.1, 0.0}}).closed, 1);
  EXPECT_EQ(compare({{15.1, 0.0}}).wrong, 0);
  // Long before it.
  EXPECT_EQ(compare({{14.1, 0.0}}).closed, 0);
  EXPECT_EQ(CompareLoops({}, {}).revisits, 0);
}

}  // namespace
}  // namespace orb360
