#include "slam/geometry/essential_matrix.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "nn/base/statistics.h"
#include "tests/slam/geometry/two_views.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

const Vector3d kMotions[] = {{-1, 0, 0}, {1, 0, 0},  {0, 1, 0},     {0, -1, 0},
                             {0, 0, 1},  {0, 0, -1}, {-1, 0.3, 0.1}};

TEST(EssentialMatrix, VanishesOnEveryPointInBothHemispheres) {
  RandomGeometry random(1);
  for (int i = 0; i < 200; ++i) {
    const Rigid3 camera1_from_camera2 = random.Transform();
    const Matrix3d essential = EssentialMatrix(camera1_from_camera2);
    const Vector3d point = random.Point(0.1, 20.0);
    const Vector3d bearing1 = point.normalized();
    const Vector3d bearing2 = (camera1_from_camera2.Inverse() * point).normalized();
    EXPECT_NEAR(bearing1.dot(essential * bearing2), 0.0, 1e-14);
    EXPECT_NEAR(AngleToPlane(EpipolarPlaneNormal(essential, bearing1), bearing2), 0.0, 1e-12);
  }
}

TEST(EssentialMatrix, AngleToPlaneIsTheAngleByWhichTheBearingLeavesIt) {
  RandomGeometry random(2);
  for (int i = 0; i < 200; ++i) {
    const Rigid3 camera1_from_camera2 = random.Transform();
    const Vector3d point = random.Point(0.1, 20.0);
    const Vector3d bearing2 = (camera1_from_camera2.Inverse() * point).normalized();
    // The plane holds both centres and the point, here in camera 2.
    const Vector3d normal = EpipoleInCamera2(camera1_from_camera2).cross(bearing2).normalized();
    const double angle = random.Uniform(-1.5, 1.5);
    const Vector3d turned = std::cos(angle) * bearing2 + std::sin(angle) * normal;
    EXPECT_NEAR(
        AngleToPlane(EpipolarPlaneNormal(EssentialMatrix(camera1_from_camera2), point.normalized()),
                     turned),
        std::abs(angle), 1e-10);
  }
}

TEST(EssentialMatrix, EpipoleIsWhereTheOtherCentreIsSeen) {
  RandomGeometry random(3);
  const Rigid3 camera1_from_camera2 = random.Transform();
  const Vector3d epipole = EpipoleInCamera2(camera1_from_camera2);
  EXPECT_LT((camera1_from_camera2 * (camera1_from_camera2.translation.norm() * epipole)).norm(),
            1e-14);
  const double keep = std::cos(0.1);
  for (const double side : {1.0, -1.0}) {  // the epipole and its antipode
    const auto at = [&](double angle) -> Vector3d {
      return side * std::cos(angle) * epipole + std::sin(angle) * epipole.unitOrthogonal();
    };
    EXPECT_FALSE(IsAwayFromEpipole(epipole, at(0.0), keep));
    EXPECT_FALSE(IsAwayFromEpipole(epipole, at(0.09), keep));
    EXPECT_TRUE(IsAwayFromEpipole(epipole, at(0.11), keep));
  }
  EXPECT_EQ(EpipolarPlaneNormal(EssentialMatrix(Rigid3()), epipole), Vector3d::Zero());
}

TEST(EstimateRelativePose, RecoversExactBearingsForEveryMotion) {
  RandomGeometry random(4);
  for (const Vector3d& motion : kMotions) {
    for (const double turn : {0.0, 0.1, kPi}) {
      const TwoViews views = MakeTwoViews({random.Rotation(turn), motion}, {}, &random);
      const auto found = EstimateRelativePose(views.bearings1, views.bearings2);
      ASSERT_TRUE(found) << motion.transpose();
      EXPECT_LT(RotationError(found->camera1_from_camera2, views.camera1_from_camera2), 1e-9);
      EXPECT_LT(DirectionError(found->camera1_from_camera2, views.camera1_from_camera2), 1e-9);
      EXPECT_NEAR(found->camera1_from_camera2.translation.norm(), 1.0, 1e-15);
      EXPECT_EQ(found->num_inliers, 300);
    }
  }
}

TEST(EstimateRelativePose, RecoversFromPointsInOneHemisphereOnly) {
  RandomGeometry random(5);
  for (const Vector3d& towards : {Vector3d(-1, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 0, -1)}) {
    const TwoViews all =
        MakeTwoViews({random.Rotation(0.3), Vector3d(0.6, 0.8, 0)}, {.sigma = 1e-4}, &random);
    std::vector<Vector3d> bearings1, bearings2;
    for (size_t i = 0; i < all.bearings1.size(); ++i) {
      if (all.bearings1[i].dot(towards) < 0.3) continue;
      bearings1.push_back(all.bearings1[i]);
      bearings2.push_back(all.bearings2[i]);
    }
    const auto found = EstimateRelativePose(bearings1, bearings2, {.sigma = 1e-4});
    ASSERT_TRUE(found);
    EXPECT_LT(RotationError(found->camera1_from_camera2, all.camera1_from_camera2), 1e-3);
    EXPECT_LT(DirectionError(found->camera1_from_camera2, all.camera1_from_camera2), 1e-2);
  }
}

TEST(EstimateRelativePose, ErrorStaysWithinWhatTheNoisePredicts) {
  RandomGeometry random(6);
  constexpr double kSigma = 1e-3;
  for (const double outliers : {0.0, 0.3, 0.5}) {
    for (const Vector3d& motion : kMotions) {
      const TwoViews views =
          MakeTwoViews({random.Rotation(0.5), motion.normalized()},
                       {.count = 600, .sigma = kSigma, .outlier_ratio = outliers}, &random);
      const auto found = EstimateRelativePose(views.bearings1, views.bearings2, {.sigma = kSigma});
      ASSERT_TRUE(found) << motion.transpose();
      // n bearings all around tell a rotation to about sqrt(2) sigma sqrt(3 / n); the translation
      // is worse by the inverse of the parallax, here about 0.1 rad. Five standard deviations.
      const double good = 600 * (1.0 - outliers);
      const double sigma = kSigma * std::sqrt(6.0 / good);
      EXPECT_LT(RotationError(found->camera1_from_camera2, views.camera1_from_camera2), 5 * sigma);
      EXPECT_LT(DirectionError(found->camera1_from_camera2, views.camera1_from_camera2),
                5 * sigma / 0.1);
      int kept_outliers = 0, lost_inliers = 0;
      for (size_t i = 0; i < views.is_outlier.size(); ++i) {
        kept_outliers += views.is_outlier[i] && found->inliers[i];
        lost_inliers += !views.is_outlier[i] && !found->inliers[i];
      }
      EXPECT_LE(kept_outliers, 0.02 * 600);  // within 3 sigma of the plane by chance: 0.5 %
      EXPECT_LE(lost_inliers, 0.02 * 600);   // beyond 3 sigma: 0.3 %
      EXPECT_EQ(found->num_inliers, std::count(found->inliers.begin(), found->inliers.end(), true));
    }
  }
}

TEST(EstimateRelativePose, WrongMatchesWithLargeParallaxDoNotHoldADistantScene) {
  RandomGeometry random(7);
  constexpr double kSigma = 1e-3;
  for (int trial = 0; trial < 10; ++trial) {
    // Median parallax 7 sigma.
    const TwoViews views =
        MakeTwoViews({random.Rotation(0.3), 0.1 * random.Bearing()},
                     {.count = 1000, .sigma = kSigma, .outlier_ratio = 0.4}, &random);
    const auto found = EstimateRelativePose(views.bearings1, views.bearings2, {.sigma = kSigma});
    ASSERT_TRUE(found);
    EXPECT_LT(DirectionError(found->camera1_from_camera2, views.camera1_from_camera2), 0.04);
  }
}

TEST(EstimateRelativePose, WeighsEveryFeatureByItsOwnNoise) {
  RandomGeometry random(8);
  // A third is exact to 1e-4, the rest to 1e-2.
  const Rigid3 truth{random.Rotation(0.5), random.Bearing()};
  const TwoViews fine = MakeTwoViews(truth, {.count = 200, .sigma = 1e-4}, &random);
  TwoViews views = MakeTwoViews(truth, {.count = 400, .sigma = 1e-2}, &random);
  std::vector<double> sigmas(400, 1e-2);
  for (size_t i = 0; i < fine.bearings1.size(); ++i) {
    views.bearings1.push_back(fine.bearings1[i]);
    views.bearings2.push_back(fine.bearings2[i]);
    sigmas.push_back(1e-4);
  }
  const auto found = EstimateRelativePose(views.bearings1, views.bearings2, sigmas, sigmas);
  ASSERT_TRUE(found);
  EXPECT_LT(RotationError(found->camera1_from_camera2, truth), 5 * 1e-4 * std::sqrt(6.0 / 200));
  EXPECT_GT(found->num_inliers, 0.98 * 600);
}

TEST(EstimateRelativePose, EachCameraMayHaveItsOwnNoise) {
  RandomGeometry random(14);
  TwoViews views = MakeTwoViews({random.Rotation(0.5), random.Bearing()}, {.sigma = 1e-4}, &random);
  for (Vector3d& bearing : views.bearings2) bearing = random.Noisy(bearing, 1e-2);
  const std::vector<double> fine(300, 1e-4), coarse(300, 1e-2);
  const auto found = EstimateRelativePose(views.bearings1, views.bearings2, fine, coarse);
  ASSERT_TRUE(found);
  EXPECT_GT(found->num_inliers, 0.98 * 300);
  const auto reverse = EstimateRelativePose(views.bearings2, views.bearings1, coarse, fine);
  ASSERT_TRUE(reverse);
  EXPECT_GT(reverse->num_inliers, 0.98 * 300);
}

TEST(EstimateRelativePose, PureRotationShowsAsParallaxOfTheNoise) {
  RandomGeometry random(10);
  constexpr double kSigma = 1e-3;
  const TwoViews views = MakeTwoViews({random.Rotation(1.0), Vector3d::Zero()},
                                      {.sigma = kSigma, .outlier_ratio = 0.2}, &random);
  const auto found = EstimateRelativePose(views.bearings1, views.bearings2, {.sigma = kSigma});
  ASSERT_TRUE(found);
  std::vector<double> parallax;
  for (size_t i = 0; i < views.bearings1.size(); ++i) {
    if (!found->inliers[i]) continue;
    parallax.push_back(AngleBetween(views.bearings1[i],
                                    found->camera1_from_camera2.rotation * views.bearings2[i]));
  }
  EXPECT_LT(Median(parallax), 2.0 * kSigma);
  EXPECT_LT(RotationError(found->camera1_from_camera2, views.camera1_from_camera2), kSigma);
}

TEST(EstimateRelativePose, KeepsFarPointsWhoseRaysTheNoiseLetsDiverge) {
  RandomGeometry random(11);
  constexpr double kSigma = 1e-3;
  TwoViews views = MakeTwoViews({random.Rotation(0.5), Vector3d(0, 1, 0)},
                                {.count = 200, .sigma = kSigma}, &random);
  const TwoViews far =
      MakeTwoViews(views.camera1_from_camera2,
                   {.count = 200, .sigma = kSigma, .nearest = 1e5, .farthest = 1e6}, &random);
  views.bearings1.insert(views.bearings1.end(), far.bearings1.begin(), far.bearings1.end());
  views.bearings2.insert(views.bearings2.end(), far.bearings2.begin(), far.bearings2.end());
  const auto found = EstimateRelativePose(views.bearings1, views.bearings2, {.sigma = kSigma});
  ASSERT_TRUE(found);
  EXPECT_GT(found->num_inliers, 0.96 * 400);
}

TEST(EstimateRelativePose, GivesTheSameTwice) {
  RandomGeometry random(12);
  const TwoViews views = MakeTwoViews({random.Rotation(0.5), random.Bearing()},
                                      {.sigma = 1e-3, .outlier_ratio = 0.4}, &random);
  const auto first = EstimateRelativePose(views.bearings1, views.bearings2);
  const auto second = EstimateRelativePose(views.bearings1, views.bearings2);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->camera1_from_camera2.rotation.coeffs(),
            second->camera1_from_camera2.rotation.coeffs());
  EXPECT_EQ(first->camera1_from_camera2.translation, second->camera1_from_camera2.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(EstimateRelativePose, GivesNothingWhereThereIsNothing) {
  RandomGeometry random(13);
  EXPECT_FALSE(EstimateRelativePose({}, {}));
  const TwoViews few = MakeTwoViews({random.Rotation(), random.Bearing()}, {.count = 4}, &random);
  EXPECT_FALSE(EstimateRelativePose(few.bearings1, few.bearings2));
  const TwoViews noise = MakeTwoViews({random.Rotation(), random.Bearing()},
                                      {.count = 100, .outlier_ratio = 1.0}, &random);
  EXPECT_FALSE(EstimateRelativePose(noise.bearings1, noise.bearings2, {.min_inliers = 20}));
  // One bearing over and over, and NaN: no geometry, no crash.
  const std::vector<Vector3d> same(50, Vector3d(0, 0, 1));
  if (const auto found = EstimateRelativePose(same, same)) {
    EXPECT_TRUE(found->camera1_from_camera2.translation.allFinite());
  }
  const std::vector<Vector3d> nan(50, Vector3d::Constant(std::nan("")));
  EXPECT_FALSE(EstimateRelativePose(nan, nan));
}

TEST(EstimateRelativePose, RefusesSpansOfDifferentLength) {
  const std::vector<Vector3d> ten(10, Vector3d(0, 0, 1)), nine(9, Vector3d(0, 0, 1));
  const std::vector<double> sigmas(9, 0.1);
  EXPECT_THROW(EstimateRelativePose(ten, nine), ContractError);
  EXPECT_THROW(EstimateRelativePose(ten, ten, sigmas, {}), ContractError);
  EXPECT_THROW(EstimateRelativePose(ten, ten, {}, sigmas), ContractError);
}

}  // namespace
}  // namespace orb360
