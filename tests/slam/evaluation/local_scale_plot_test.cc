#include "slam/evaluation/local_scale_plot.h"

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const Eigen::Vector2d kOrigin(70, 940);
const Eigen::Vector2d kSize(1300, 240);

/// Windows every 5 m whose ratio is `first` at 0 m and grows by exp(`rate`) each metre.
LocalScale Drifting(int count, double first, double rate) {
  LocalScale scale;
  for (int i = 0; i < count; ++i) {
    scale.windows.push_back({5.0 * i, first * std::exp(5.0 * rate * i)});
  }
  scale.min = std::min(scale.windows.front().ratio, scale.windows.back().ratio);
  scale.max = std::max(scale.windows.front().ratio, scale.windows.back().ratio);
  return scale;
}

/// All "x,y" of each polyline.
std::vector<std::vector<Eigen::Vector2d>> Polylines(const std::string& svg) {
  std::vector<std::vector<Eigen::Vector2d>> lines;
  for (size_t at = svg.find("<polyline"); at != std::string::npos;
       at = svg.find("<polyline", at + 1)) {
    const size_t begin = svg.find("points=\"", at) + 8;
    std::istringstream list(svg.substr(begin, svg.find('"', begin) - begin));
    std::vector<Eigen::Vector2d> points;
    Eigen::Vector2d point;
    char comma = 0;
    while (list >> point.x() >> comma >> point.y()) points.push_back(point);
    lines.push_back(points);
  }
  return lines;
}

TEST(DrawLocalScale, AConstantRateOfDriftIsAStraightLine) {
  const auto lines = Polylines(DrawLocalScale(Drifting(201, 0.5, 0.003), kOrigin, kSize));
  ASSERT_EQ(lines.size(), 1u);
  const std::vector<Eigen::Vector2d>& line = lines.front();
  ASSERT_EQ(line.size(), 201u);
  for (size_t i = 0; i < line.size(); ++i) {
    const double t = static_cast<double>(i) / 200.0;
    EXPECT_LT((line[i] - ((1.0 - t) * line.front() + t * line.back())).norm(), 0.2) << i;
  }
}

TEST(DrawLocalScale, ARatioStandsInTheMiddleOfItsWindow) {
  // One window from 0 to 20 m fills the frame.
  const std::string svg = DrawLocalScale(Drifting(1, 1.1, 0.0), kOrigin, kSize);
  EXPECT_TRUE(Polylines(svg).empty());
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"720.0\""));
}

TEST(DrawLocalScale, TheLineHasAGapWhereWindowsAreMissing) {
  LocalScale scale = Drifting(100, 1.0, 0.0001);
  scale.windows.erase(scale.windows.begin() + 40, scale.windows.begin() + 45);
  const auto lines = Polylines(DrawLocalScale(scale, kOrigin, kSize));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].size(), 40u);
  EXPECT_EQ(lines[1].size(), 55u);
}

TEST(DrawLocalScale, EverythingLiesInTheFrameWhateverTheRatios) {
  for (const double first : {1e-6, 0.7, 1.0, 1.001, 40.0, 1e6}) {
    for (const double rate : {-0.01, 0.0, 1e-7, 0.003}) {
      const std::string svg = DrawLocalScale(Drifting(201, first, rate), kOrigin, kSize);
      EXPECT_THAT(svg, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
      const auto lines = Polylines(svg);
      ASSERT_EQ(lines.size(), 1u);
      for (const Eigen::Vector2d& point : lines.front()) {
        EXPECT_TRUE(point.x() >= 70 && point.x() <= 1370 && point.y() >= 700 && point.y() <= 940)
            << first << ' ' << rate << ": " << point.transpose();
      }
    }
  }
}

TEST(DrawLocalScale, TheGridHasAFewRatiosInEveryRange) {
  const auto labels = [](double min, double max) {
    LocalScale scale = Drifting(2, min, std::log(max / min) / 5.0);
    const std::string svg = DrawLocalScale(scale, kOrigin, kSize);
    size_t count = 0;
    const std::string left = "text-anchor=\"end\"";
    for (size_t at = svg.find(left); at != std::string::npos; at = svg.find(left, at + 1)) ++count;
    return count;
  };
  for (const double max : {1.0001, 1.01, 1.3, 2.0, 3.0, 20.0, 50.0, 1e4, 1e6}) {
    EXPECT_GE(labels(0.99, max), 2u) << max;
    EXPECT_LE(labels(0.99, max), 12u) << max;
  }
}

TEST(DrawLocalScale, TheTitleTellsTheDriftOrThatThereIsNone) {
  LocalScale scale = Drifting(50, 1.0, 0.0);
  EXPECT_THAT(DrawLocalScale(scale, kOrigin, kSize), HasSubstr("median none, largest none"));
  scale.drift_median = 0.0123;
  scale.drift_worst = 2.34;
  EXPECT_THAT(DrawLocalScale(scale, kOrigin, kSize), HasSubstr("median 1.23 %, largest 234.00 %"));
}

}  // namespace
}  // namespace orb360
