#include "slam/depth/geometric_consistency.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
const RangeRoom kRoom;

/// Cameras along a gentle curve.
std::vector<Rigid3> Cameras() {
  std::vector<Rigid3> cameras;
  for (int i = 0; i < 7; ++i) {
    cameras.push_back(TurnedCamera({-1.2 + 0.4 * i, 0.3 - 0.02 * i * i, 0.1}, 0.15 * i));
  }
  return cameras;
}

std::vector<DepthView> Views(const std::vector<DenseDepth>& depths,
                             const GeometricConsistencyOptions& options = {}) {
  std::vector<DepthView> views;
  const std::vector<Rigid3> cameras = Cameras();
  for (size_t i = 0; i < depths.size(); ++i) {
    views.emplace_back(depths[i], cameras[i], options.min_error);
  }
  return views;
}

/// The points of the view in the middle, compared with all others.
std::vector<ConsistentPoint> ConsistentPointsOfTheMiddle(
    const std::vector<DepthView>& views, const GeometricConsistencyOptions& options = {},
    int num_threads = 1) {
  std::vector<const DepthView*> others;
  for (size_t i = 0; i < views.size(); ++i) {
    if (i != views.size() / 2) others.push_back(&views[i]);
  }
  return FindConsistentPoints(views[views.size() / 2], others, options, {.spacing = 0.02},
                              num_threads);
}

std::vector<DenseDepth> RenderAll(double confidence = 0.99) {
  std::vector<DenseDepth> depths;
  for (const Rigid3& camera : Cameras()) {
    depths.push_back(kRoom.Render(kCamera, camera, std::nullopt, confidence));
  }
  return depths;
}

TEST(FindConsistentPoints, KeepsTheWallsAndEveryDirectionEqually) {
  const std::vector<DepthView> views = Views(RenderAll());
  const std::vector<ConsistentPoint> points = ConsistentPointsOfTheMiddle(views);
  // A pixel at the equator stands for (2 pi / 256)^2 sr.
  const double expected = 4.0 * std::numbers::pi / std::pow(kCamera.AngleOfPixels(1.0), 2);
  EXPECT_GT(points.size(), 0.9 * expected);
  EXPECT_LT(points.size(), 1.1 * expected);
  int in_caps = 0;
  for (const ConsistentPoint& point : points) {
    EXPECT_LT(kRoom.DistanceFromWalls(point.position), 0.04);
    in_caps += std::abs(point.row + 0.5 - 64) > 64 - 128 / 6.0;  // beyond 60 degrees
  }
  EXPECT_NEAR(in_caps / static_cast<double>(points.size()), 1.0 - std::sqrt(0.75), 0.02);
}

TEST(FindConsistentPoints, RangesAtBoundariesAreNoPointsAndSupportNone) {
  std::vector<DenseDepth> depths = RenderAll();
  const auto number_of_points = [&] { return ConsistentPointsOfTheMiddle(Views(depths)).size(); };
  const size_t all = number_of_points();
  const auto state = [&](size_t view, RangeSource source) {
    depths[view].source =
        cv::Mat(depths[view].range.size(), CV_8U, cv::Scalar(static_cast<double>(source)));
  };
  for (size_t i = 0; i < depths.size(); ++i) state(i, RangeSource::kMeasured);
  EXPECT_EQ(number_of_points(), all);
  state(depths.size() / 2, RangeSource::kBoundary);
  EXPECT_EQ(number_of_points(), 0U);
  for (size_t i = 0; i < depths.size(); ++i) state(i, RangeSource::kBoundary);
  state(depths.size() / 2, RangeSource::kMeasured);
  EXPECT_EQ(number_of_points(), 0U);
}

TEST(FindConsistentPoints, TakesEveryOtherPixelWherePixelsAreDense) {
  const std::vector<DepthView> views = Views(RenderAll());
  const size_t all = ConsistentPointsOfTheMiddle(views).size();
  std::vector<const DepthView*> others{&views[0], &views[1], &views[2]};
  // Pixels are 0.037 apart at the nearest wall, 0.1 at the farthest.
  const size_t fewer = FindConsistentPoints(views[3], others, {}, {.spacing = 0.25}).size();
  EXPECT_LT(fewer, all / 3);
  EXPECT_GT(fewer, all / 18);
}

TEST(FindConsistentPoints, RefusesWhatMoves) {
  std::vector<DenseDepth> depths;
  std::vector<Ball> balls;
  for (int i = 0; i < 7; ++i) {
    balls.push_back({{-2.0 + 0.6 * i, -1.2, 0.0}, 0.4});
    depths.push_back(kRoom.Render(kCamera, Cameras()[static_cast<size_t>(i)], balls.back()));
  }
  const std::vector<ConsistentPoint> points = ConsistentPointsOfTheMiddle(Views(depths));
  EXPECT_GT(points.size(), 6000u);
  const auto on_ball = [&](const ConsistentPoint& point) {
    return std::abs((point.position - balls[3].centre).norm() - balls[3].radius) < 0.1 &&
           kRoom.DistanceFromWalls(point.position) > 0.3;
  };
  EXPECT_EQ(std::ranges::count_if(points, on_ball), 0);

  // The same ball standing still is kept.
  for (int i = 0; i < 7; ++i) {
    depths[static_cast<size_t>(i)] =
        kRoom.Render(kCamera, Cameras()[static_cast<size_t>(i)], balls[3]);
  }
  EXPECT_GT(std::ranges::count_if(ConsistentPointsOfTheMiddle(Views(depths)), on_ball), 50);
}

TEST(FindConsistentPoints, RefusesWhatOneKeyframeInvents) {
  std::vector<DenseDepth> depths = RenderAll();
  depths[3].range(cv::Rect(100, 50, 20, 20)) *= 0.7;
  depths[3].range(cv::Rect(0, 80, 20, 20)) *= 1.4;
  for (const ConsistentPoint& point : ConsistentPointsOfTheMiddle(Views(depths))) {
    EXPECT_LT(kRoom.DistanceFromWalls(point.position), 0.15);
  }
}

TEST(FindConsistentPoints, ViewsThatHardlyKnowTheRangeSupportNothing) {
  // As in the sky: the network gives it a range with an expected error as large as that.
  std::vector<DenseDepth> depths = RenderAll(0.5);
  depths[3] = RenderAll()[3];
  depths[3].range *= 0.7;
  EXPECT_TRUE(ConsistentPointsOfTheMiddle(Views(depths)).empty());
}

TEST(FindConsistentPoints, RefusesWhatTooFewSee) {
  const std::vector<DenseDepth> depths = RenderAll();
  GeometricConsistencyOptions options;
  options.min_support = 7;
  EXPECT_TRUE(ConsistentPointsOfTheMiddle(Views(depths), options).empty());
}

TEST(FindConsistentPoints, TheMeanOfAllIsMoreAccurateThanOne) {
  // 4 % of noise that is the same over 8 x 8 pixels, and a confidence that says so.
  std::vector<DenseDepth> depths = RenderAll(1.0 / 1.032);
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0.0f, 0.04f);
  double squared_alone = 0;
  int alone = 0;
  for (size_t i = 0; i < depths.size(); ++i) {
    for (int row = 0; row < 128; row += 8) {
      for (int column = 0; column < 256; column += 8) {
        depths[i].range(cv::Rect(column, row, 8, 8)) *= std::exp(normal(random));
      }
    }
  }
  const std::vector<DepthView> views = Views(depths);
  GeometricConsistencyOptions options;
  options.redundant_ratio = 1e9;
  double squared = 0;
  const std::vector<ConsistentPoint> points = ConsistentPointsOfTheMiddle(views, options);
  for (const ConsistentPoint& point : points) {
    squared += std::pow(kRoom.DistanceFromWalls(point.position), 2);
    const double own = views[3].range(point.row, point.column);
    squared_alone += std::pow(
        kRoom.DistanceFromWalls(Cameras()[3] *
                                (own * views[3].BearingOf(point.row, point.column).cast<double>())),
        2);
    ++alone;
  }
  EXPECT_GT(points.size(), 7000u);
  EXPECT_LT(std::sqrt(squared / alone), 0.7 * std::sqrt(squared_alone / alone));
}

TEST(FindConsistentPoints, LeavesPointsToKeyframesThatSeeThemBetter) {
  std::vector<DenseDepth> depths = RenderAll();
  depths[3].confidence.setTo(0.9f);  // An error of 11 % where the others have 1 %.
  const size_t left = ConsistentPointsOfTheMiddle(Views(depths)).size();
  GeometricConsistencyOptions options;
  options.redundant_ratio = 1e9;
  const size_t all = ConsistentPointsOfTheMiddle(Views(depths), options).size();
  EXPECT_GT(all, 1000u);
  EXPECT_LT(left, all / 50);
}

TEST(FindConsistentPoints, RangesOfNextToNothingEndAsWell) {
  std::vector<DenseDepth> depths = RenderAll();
  depths[3].range.at<float>(0, 0) = 1e-12f;
  depths[3].range.at<float>(64, 7) = 1e-30f;
  EXPECT_GT(ConsistentPointsOfTheMiddle(Views(depths)).size(), 7000u);
}

TEST(FindConsistentPoints, IsTheSameForAnyNumberOfThreads) {
  const std::vector<DepthView> views = Views(RenderAll());
  const std::vector<ConsistentPoint> one = ConsistentPointsOfTheMiddle(views);
  const std::vector<ConsistentPoint> three = ConsistentPointsOfTheMiddle(views, {}, 3);
  ASSERT_EQ(one.size(), three.size());
  for (size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].position, three[i].position);
    ASSERT_EQ(one[i].normal, three[i].normal);
    ASSERT_EQ(one[i].error, three[i].error);
  }
}

}  // namespace
}  // namespace orb360
