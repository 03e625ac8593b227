#include "slam/features/feature_index.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

constexpr double kSigma = 0.001;  // rad, on level 0

double SigmaOf(int level) { return kSigma * std::exp2(level / 4.0); }

void Add(const Eigen::Vector3d& bearing, int level, Features* features) {
  features->bearings.push_back(bearing);
  features->keypoints.push_back({Eigen::Vector2f::Zero(), 0.0F, static_cast<float>(SigmaOf(level)),
                                 static_cast<uint8_t>(level), 50});
}

// `angle` away from the bearing, in the direction `turn` of its tangent plane.
Eigen::Vector3d Beside(const Eigen::Vector3d& bearing, double angle, double turn) {
  const Eigen::Vector3d east = bearing.unitOrthogonal();
  const Eigen::Vector3d direction = std::cos(turn) * east + std::sin(turn) * bearing.cross(east);
  return std::cos(angle) * bearing + std::sin(angle) * direction;
}

TEST(FeatureIndex, FeaturesOfOneCornerOnNeighbouringLevelsAreThoseOfTheFinest) {
  RandomGeometry random(1);
  std::vector<Eigen::Vector3d> places = {-Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitY()};
  for (int i = 0; i < 10; ++i) places.push_back(random.Bearing());
  Features features;
  for (int level = 6; level >= 1; --level) {  // in whatever order
    for (const Eigen::Vector3d& place : places) {
      Add(Beside(place, 0.5 * SigmaOf(level), random.Uniform(0.0, 6.0)), level, &features);
    }
  }
  IndexFeatures(&features);
  const int num_places = static_cast<int>(places.size());
  ASSERT_EQ(std::ssize(features.corners), 6 * num_places);
  for (int f = 0; f < features.size(); ++f) {
    EXPECT_EQ(features.corners[f], 5 * num_places + f % num_places) << f;
  }
}

TEST(FeatureIndex, CornersOnOneLevelWithALevelBetweenOrTooFarApartAreOnesOfTheirOwn) {
  Features features;
  const Eigen::Vector3d first = Eigen::Vector3d::UnitX();
  Add(first, 2, &features);
  Add(Beside(first, 0.1 * kSigma, 1.0), 2, &features);
  Add(Beside(first, 0.1 * kSigma, 2.0), 4, &features);
  const Eigen::Vector3d second = Eigen::Vector3d::UnitY();
  Add(second, 0, &features);
  Add(Beside(second, 2.1 * SigmaOf(1), 1.0), 1, &features);
  IndexFeatures(&features);
  EXPECT_EQ(features.corners, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(FeatureIndex, OfTwoCornersWithinReachItIsTheNearerOne) {
  Features features;
  const Eigen::Vector3d place = Eigen::Vector3d::UnitX();
  Add(Beside(place, 1.5 * kSigma, 0.0), 0, &features);
  Add(Beside(place, 1.0 * kSigma, 3.0), 0, &features);
  Add(place, 1, &features);
  IndexFeatures(&features);
  EXPECT_EQ(features.corners[2], 1);
}

TEST(FeatureIndex, WhatIsNoCornerStandsForItselfAndIsNotFound) {
  Features features;
  const Eigen::Vector3d place = Eigen::Vector3d::UnitX();
  Add(place, 0, &features);
  Add(place, 1, &features);
  features.keypoints.back().score = 0;
  IndexFeatures(&features);
  EXPECT_EQ(features.corners, (std::vector<int>{0, 1}));
  std::vector<int> found;
  features.grid.Query(place, kSigma, &found);
  EXPECT_EQ(found, std::vector<int>{0});
}

TEST(FeatureIndex, OfNoFeaturesIsEmpty) {
  Features features;
  features.corners = {3};
  IndexFeatures(&features);
  EXPECT_TRUE(features.corners.empty());
}

}  // namespace
}  // namespace orb360
