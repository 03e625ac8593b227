#include "slam/evaluation/map_plot.h"

#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A straight path of ten metres.
const std::vector<Eigen::Vector2d> kPath = {{0, 0}, {5, 0}, {10, 0}};

/// Centres of all circles, in their order.
std::vector<Eigen::Vector2d> Circles(const std::string& svg) {
  std::vector<Eigen::Vector2d> centres;
  const std::regex circle("<circle cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), circle), end; it != end; ++it)
    centres.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  return centres;
}

TEST(PlotMap, KeyframesStandWhereTheyAreWithYUpward) {
  const std::string svg = PlotMap(std::vector<Eigen::Vector2d>{{0, 0}, {4, 0}, {4, 3}}, {}, {});
  const std::vector<Eigen::Vector2d> at = Circles(svg);
  ASSERT_EQ(at.size(), 4u);  // the first has a ring around it
  const double scale = (at[1].x() - at[0].x()) / 4;
  EXPECT_GT(scale, 0);
  EXPECT_NEAR(at[1].y() - at[2].y(), 3 * scale, 0.2);
  EXPECT_EQ(at[3], at[0]);
}

TEST(PlotMap, LinksJoinTheirKeyframes) {
  const std::string svg = PlotMap(kPath, std::vector<MapLink>{{0, 2, 1.0}}, {});
  const std::vector<Eigen::Vector2d> at = Circles(svg);
  std::smatch link;
  ASSERT_TRUE(std::regex_search(svg, link, std::regex("M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)")));
  EXPECT_EQ(std::stod(link[1]), at[0].x());
  EXPECT_EQ(std::stod(link[3]), at[2].x());
}

TEST(PlotMap, AFewFarLandmarksAreLeftOutInsteadOfShrinkingThePath) {
  std::vector<Eigen::Vector2d> landmarks;
  for (int i = 0; i < 100; ++i) landmarks.emplace_back(0.1 * i, i % 7 - 3.0);
  const std::string near_only = PlotMap(kPath, {}, landmarks);
  landmarks.emplace_back(1e6, -1e7);
  const std::string with_far = PlotMap(kPath, {}, landmarks);
  const auto width = [](const std::string& svg) {
    const std::vector<Eigen::Vector2d> at = Circles(svg);
    return at[2].x() - at[0].x();
  };
  EXPECT_NEAR(width(with_far), width(near_only), 0.1 * width(near_only));
  EXPECT_EQ(std::count(with_far.begin(), with_far.end(), 'h'),
            std::count(near_only.begin(), near_only.end(), 'h'));
}

TEST(PlotMap, OneKeyframeAloneCanBeDrawn) {
  const std::string svg = PlotMap(std::vector<Eigen::Vector2d>{{3, 4}}, {}, {});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace orb360
