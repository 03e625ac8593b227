#include "apps/town/sequence/statistics.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360::town {
namespace {

/// A camera at a place that looks in a compass direction (radians, from +x to +y).
Rigid3 Looking(double x, double y, double heading) {
  const Eigen::Quaterniond level(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  return {Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * level),
          {x, y, 2}};
}

/// `metres` straight on in steps of a metre.
void DriveOn(double heading, int metres, std::vector<Rigid3>* path) {
  for (int i = 0; i < metres; ++i) {
    const Eigen::Vector3d from = path->back().translation;
    path->push_back(Looking(from.x() + std::cos(heading), from.y() + std::sin(heading), heading));
  }
}

TEST(FindRevisits, AStraightRoadIsNeverRevisited) {
  std::vector<Rigid3> path = {Looking(0, 0, 0)};
  DriveOn(0, 300, &path);
  EXPECT_EQ(FindRevisits(path).same_fraction, 0);
  EXPECT_EQ(FindRevisits(path).opposite_fraction, 0);
}

TEST(FindRevisits, TheWayBackIsSeenInTheOppositeDirection) {
  std::vector<Rigid3> path = {Looking(0, 0, 0)};
  DriveOn(0, 200, &path);
  DriveOn(std::numbers::pi, 200, &path);
  const Revisits revisits = FindRevisits(path);
  EXPECT_EQ(revisits.same_fraction, 0);
  // All of the way back but about the first 25 m: less than 50 m of travel since.
  EXPECT_NEAR(revisits.opposite_fraction, (200 - 25) / 400.0, 0.02);
}

TEST(FindRevisits, ASecondRoundIsSeenInTheSameDirection) {
  std::vector<Rigid3> path = {Looking(0, 0, 0)};
  for (int round = 0; round < 2; ++round) {
    for (int side = 0; side < 4; ++side) DriveOn(side * std::numbers::pi / 2, 50, &path);
  }
  const Revisits revisits = FindRevisits(path);
  EXPECT_NEAR(revisits.same_fraction, 0.5, 0.02);
  EXPECT_EQ(revisits.opposite_fraction, 0);
}

TEST(StatisticsTable, HasAColumnForEachDrive) {
  DriveStatistics a;
  a.path_length = 123.4;
  DriveStatistics b;
  b.path_length = 567.8;
  const std::string table =
      StatisticsTable(std::vector<std::string>{"A", "B"}, std::vector<DriveStatistics>{a, b});
  EXPECT_THAT(table, testing::HasSubstr("| | A | B |\n"));
  EXPECT_THAT(table, testing::HasSubstr("| path, m | 123 | 568 |\n"));
}

}  // namespace
}  // namespace orb360::town
