#include "slam/evaluation/trajectory_plot.h"

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A path of `count` poses bent like an S, 3 m by 1 m.
std::vector<StampedPose> Bend(int count, double error) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / count;
    poses.push_back({t,
                     {Eigen::Quaterniond::Identity(),
                      {3.0 * t, std::sin(6.0 * t) + error * std::sin(31.0 * t), 0.0}}});
  }
  return poses;
}

std::string Plot(int count, double error) {
  const std::vector<StampedPose> truth = Bend(count, 0.0);
  const std::vector<PosePair> pairs = PairPoses(truth, Bend(count, error), 1e-6);
  return PlotTrajectory(truth, pairs, *EvaluateTrajectory(pairs), std::nullopt);
}

/// All "x,y" of the n-th polyline.
std::vector<Eigen::Vector2d> PolylinePoints(const std::string& svg, int n) {
  size_t at = 0;
  for (int i = 0; i <= n; ++i) at = svg.find("<polyline", at + 1);
  const size_t begin = svg.find("points=\"", at) + 8;
  std::istringstream list(svg.substr(begin, svg.find('"', begin) - begin));
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d point;
  char comma = 0;
  while (list >> point.x() >> comma >> point.y()) points.push_back(point);
  return points;
}

TEST(PlotTrajectory, AMetreIsTheSameInBothDirections) {
  const std::vector<Eigen::Vector2d> path = PolylinePoints(Plot(200, 0.05), 0);
  ASSERT_EQ(path.size(), 200u);
  const double pixels_per_metre = (path[199].x() - path[0].x()) / (3.0 * 199 / 200);
  for (int i = 0; i < 200; ++i) {
    const double y = std::sin(6.0 * i / 200);
    EXPECT_NEAR(path[0].y() - path[i].y(), pixels_per_metre * y, 0.2);
  }
}

TEST(PlotTrajectory, EverythingLiesInsideTheImageWhateverTheErrors) {
  for (const double error : {0.0, 1e-9, 0.05, 5.0, 1e5}) {
    const std::string svg = Plot(100, error);
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, Not(HasSubstr("inf")));
    for (const int polyline : {0, 1}) {
      for (const Eigen::Vector2d& point : PolylinePoints(svg, polyline)) {
        EXPECT_GE(point.minCoeff(), 0.0);
        EXPECT_LE(point.x(), 1400.0);
        EXPECT_LE(point.y(), 640.0);
      }
    }
  }
}

TEST(PlotTrajectory, PathsLieInsideTheirFrames) {
  const std::string svg = Plot(200, 0.05);
  for (const Eigen::Vector2d& point : PolylinePoints(svg, 0)) {
    EXPECT_TRUE(point.x() > 70 && point.x() < 650 && point.y() > 60 && point.y() < 580) << point;
  }
  for (const Eigen::Vector2d& point : PolylinePoints(svg, 1)) {
    EXPECT_TRUE(point.x() >= 740 && point.x() <= 1370 && point.y() > 60 && point.y() <= 580)
        << point;
  }
}

TEST(PlotTrajectory, TheLocalScaleStandsBelowWhereThereIsOne) {
  std::vector<StampedPose> truth = Bend(200, 0.0);
  for (StampedPose& pose : truth) pose.world_from_camera.translation *= 20.0;
  const std::vector<PosePair> pairs = PairPoses(truth, truth, 1e-6);
  const auto errors = EvaluateTrajectory(pairs);
  const auto scale = MeasureLocalScale(truth, pairs);
  ASSERT_TRUE(errors && scale);
  const std::string without = PlotTrajectory(truth, pairs, *errors, std::nullopt);
  const std::string with = PlotTrajectory(truth, pairs, *errors, scale);
  EXPECT_THAT(without, Not(HasSubstr("local scale")));
  EXPECT_THAT(with, HasSubstr("local scale"));
  for (const Eigen::Vector2d& point : PolylinePoints(with, 2)) {
    EXPECT_TRUE(point.y() > 640 && point.y() < 1000) << point;
  }
}

TEST(PlotTrajectory, LongTrajectoriesAreThinned) {
  EXPECT_LT(Plot(100000, 0.05).size(), 2'000'000u);
  EXPECT_GT(PolylinePoints(Plot(100000, 0.05), 0).size(), 2000u);
}

}  // namespace
}  // namespace orb360
