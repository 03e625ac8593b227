#include "slam/pipeline/assumed_height.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

constexpr double kHeight = 1.5;
const KnownGround kGround{.up = Eigen::Vector3d::UnitZ(), .camera_height = kHeight};

// Two keyframes kHeight above z = 0, 50 m apart, the second of which observes all points.
Map Observe(const std::vector<Eigen::Vector3d>& points) {
  Map map;
  for (int i = 0; i < 2; ++i) {
    const Rigid3 pose{Eigen::Quaterniond::Identity(), {50.0 * i, 0, kHeight}};
    auto features = std::make_shared<Features>();
    features->bearings.assign(points.size(), Eigen::Vector3d::UnitX());
    features->keypoints.resize(points.size());
    features->descriptors.resize(points.size());
    map.AddKeyframe(i, 0.1 * i, pose, std::move(features));
  }
  for (size_t p = 0; p < points.size(); ++p) {
    map.AddObservation(map.AddLandmark(points[p], Color{}), 1, static_cast<int>(p));
  }
  return map;
}

// Two hundred points on a wall of this height beside the second keyframe.
std::vector<Eigen::Vector3d> Wall(double height) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(50, 5, height * i / 199.0);
  return points;
}

double RiseOf(const Map& map) {
  const std::optional<KnownGround> ground = kGround;
  return RiseOfSurroundings(std::span(&map, 1), std::span(&ground, 1));
}

TEST(RiseOfSurroundings, IsTheirHeightOverTheGroundInHeightsOfTheCamera) {
  EXPECT_NEAR(RiseOf(Observe(Wall(9.0))), 0.9 * 9.0 / kHeight, 0.05);
}

TEST(RiseOfSurroundings, IgnoresWhatIsFarFromTheKeyframesThatObserveIt) {
  std::vector<Eigen::Vector3d> points = Wall(3.0);
  for (int i = 0; i < 200; ++i) points.emplace_back(0, 0, 40);  // near the first keyframe
  EXPECT_NEAR(RiseOf(Observe(points)), 0.9 * 3.0 / kHeight, 0.05);
}

TEST(RiseOfSurroundings, IsMeasuredFromTheNearestKeyframe) {
  for (const KeyframeId near : {0, 1}) {
    Map map = Observe(Wall(9.0));
    for (LandmarkId id = 0; id < map.landmark_end(); ++id) map.AddObservation(id, 0, id);
    // The road climbs by 5 m towards the wall.
    map.keyframe(near).world_from_camera.translation = {50, 0, kHeight};
    map.keyframe(1 - near).world_from_camera.translation = {20, 0, kHeight - 5};
    EXPECT_NEAR(RiseOf(map), 0.9 * 9.0 / kHeight, 0.05) << near;
  }
}

TEST(RiseOfSurroundings, IsUnknownFromFewLandmarksOrWithoutGround) {
  std::vector<Eigen::Vector3d> points = Wall(9.0);
  const Map map = Observe(points);
  const std::optional<KnownGround> none;
  EXPECT_EQ(RiseOfSurroundings(std::span(&map, 1), std::span(&none, 1)), 0.0);
  points.resize(99);
  EXPECT_EQ(RiseOf(Observe(points)), 0.0);
}

TEST(AssumedHeightSigma, IsThatOfCarriersWhereSurroundingsRiseHighAboveTheCamera) {
  for (const double rise : {6.0, 9.0, 15.0}) {
    EXPECT_NEAR(AssumedHeightSigma(rise), 0.25, 0.04) << rise;
  }
}

TEST(AssumedHeightSigma, IsLargeWhereTheCameraMayFly) {
  EXPECT_GT(AssumedHeightSigma(2.0), 0.3);
  EXPECT_GT(AssumedHeightSigma(0.0), 0.3) << "nothing tells";
  EXPECT_GT(AssumedHeightSigma(1.0), AssumedHeightSigma(2.0));
}

TEST(AssumedHeightSigma, IsThatOfThePosteriorDistribution) {
  // The same by numerical integration over ln(height).
  const auto normal = [](double x, double mean, double sigma) {
    const double z = (x - mean) / sigma;
    return std::exp(-0.5 * z * z) / (sigma * std::sqrt(2 * std::numbers::pi));
  };
  for (const double rise : {1.0, 4.0, 12.0}) {
    double sum = 0;
    double sum_of_squares = 0;
    for (double x = -6; x < 8; x += 1e-3) {
      const double prior =
          0.97 * normal(x, std::log(1.6), 0.25) + 0.03 * normal(x, std::log(6.0), 1.0);
      const double density = prior * normal(std::log(rise), std::log(12.0) - x, 0.8);
      sum += density;
      sum_of_squares += density * std::pow(x - std::log(1.6), 2);
    }
    EXPECT_NEAR(AssumedHeightSigma(rise), std::sqrt(sum_of_squares / sum), 1e-3) << rise;
  }
}

}  // namespace
}  // namespace orb360
