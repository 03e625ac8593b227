#include "slam/geometry/relative_rotation.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/two_views.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Vector3d;

TEST(EstimateRotation, RecoversExactBearingsForEveryAngle) {
  RandomGeometry random(1);
  for (const double angle : {0.0, 1e-6, 0.5, 3.0, std::numbers::pi}) {
    const TwoViews views =
        MakeTwoViews({ExpSo3(angle * random.Bearing()), Vector3d::Zero()}, {}, &random);
    const auto found = EstimateRotation(views.bearings1, views.bearings2);
    ASSERT_TRUE(found);
    EXPECT_LT(RotationError(found->camera1_from_camera2, views.camera1_from_camera2), 1e-12);
    EXPECT_EQ(found->camera1_from_camera2.translation, Vector3d::Zero());
    EXPECT_EQ(found->num_inliers, 300);
  }
}

TEST(EstimateRotation, ErrorStaysWithinWhatTheNoisePredicts) {
  RandomGeometry random(2);
  constexpr double kSigma = 1e-3;
  for (const double outliers : {0.0, 0.3, 0.5, 0.7}) {
    const TwoViews views = MakeTwoViews({random.Rotation(), Vector3d::Zero()},
                                        {.sigma = kSigma, .outlier_ratio = outliers}, &random);
    const auto found = EstimateRotation(views.bearings1, views.bearings2,
                                        {.sigma = kSigma, .min_inlier_ratio = 0.2});
    ASSERT_TRUE(found);
    // Each axis is told by two thirds of 2 n tangent components of noise sqrt(2) sigma; five times
    // the norm of three of them.
    const double good = 300 * (1.0 - outliers);
    EXPECT_LT(RotationError(found->camera1_from_camera2, views.camera1_from_camera2),
              5 * kSigma * std::sqrt(3 * 2.0 / (4.0 / 3.0 * good)));
    EXPECT_GT(found->num_inliers, 0.95 * (300 - views.num_outliers));
    EXPECT_LE(found->num_inliers, 300 - views.num_outliers + 3);
  }
}

TEST(EstimateRotation, FitsFarFewerThanTheRelativePoseOnceTheCameraMoves) {
  RandomGeometry random(3);
  const TwoViews views =
      MakeTwoViews({random.Rotation(0.5), Vector3d(0, 0, 1)}, {.sigma = 1e-3}, &random);
  const auto found =
      EstimateRotation(views.bearings1, views.bearings2, {.sigma = 1e-3, .min_inliers = 2});
  ASSERT_TRUE(found);
  EXPECT_LT(found->num_inliers, 100);
  EXPECT_GT(EstimateRelativePose(views.bearings1, views.bearings2, {.sigma = 1e-3})->num_inliers,
            290);
}

TEST(EstimateRotation, WeighsEveryFeatureByItsOwnNoise) {
  RandomGeometry random(4);
  const Rigid3 truth{random.Rotation(), Vector3d::Zero()};
  const TwoViews fine = MakeTwoViews(truth, {.count = 100, .sigma = 5e-4}, &random);
  TwoViews views = MakeTwoViews(truth, {.count = 300, .sigma = 1e-2}, &random);
  std::vector<double> sigmas(300, 1e-2);
  for (size_t i = 0; i < fine.bearings1.size(); ++i) {
    views.bearings1.push_back(fine.bearings1[i]);
    views.bearings2.push_back(fine.bearings2[i]);
    sigmas.push_back(5e-4);
  }
  const auto found = EstimateRotation(views.bearings1, views.bearings2, sigmas, sigmas);
  ASSERT_TRUE(found);
  // As from the hundred alone; the three hundred would tell it to 1e-3.
  EXPECT_LT(RotationError(found->camera1_from_camera2, truth), 5 * 5e-4 * std::sqrt(4.5 / 100));
}

TEST(EstimateRotation, GivesTheSameTwice) {
  RandomGeometry random(5);
  const TwoViews views = MakeTwoViews({random.Rotation(), Vector3d::Zero()},
                                      {.sigma = 3e-3, .outlier_ratio = 0.5}, &random);
  EXPECT_EQ(
      EstimateRotation(views.bearings1, views.bearings2)->camera1_from_camera2.rotation.coeffs(),
      EstimateRotation(views.bearings1, views.bearings2)->camera1_from_camera2.rotation.coeffs());
}

TEST(EstimateRotation, GivesNothingWhereThereIsNothing) {
  EXPECT_FALSE(EstimateRotation({}, {}));
  const std::vector<Vector3d> one = {Vector3d(0, 0, 1)};
  EXPECT_FALSE(EstimateRotation(one, one));
  const std::vector<Vector3d> same(50, Vector3d(0, 0, 1));  // the turn about it is unknown
  EXPECT_FALSE(EstimateRotation(same, same));
  EXPECT_THROW(EstimateRotation(one, same), ContractError);
}

}  // namespace
}  // namespace orb360
