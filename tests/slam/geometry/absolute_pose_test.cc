#include "slam/geometry/absolute_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Vector3d;

struct Scene {
  Rigid3 camera_from_world;
  std::vector<Vector3d> points, bearings;
  std::vector<bool> is_outlier;
};

struct SceneOptions {
  int count = 200;
  double sigma = 0.0;
  double outlier_ratio = 0.0;
  /// Where the points are as the camera sees it: within `half_angle` of a direction.
  Vector3d towards = Vector3d(0, 0, 1);
  double half_angle = 4.0;
};

Scene MakeScene(const SceneOptions& options, RandomGeometry* random) {
  Scene scene;
  scene.camera_from_world = random->Transform();
  while (static_cast<int>(scene.points.size()) < options.count) {
    const Vector3d in_camera = random->Point(1.0, 20.0);
    if (AngleBetween(in_camera, options.towards) > options.half_angle) continue;
    const bool is_outlier = random->Uniform(0.0, 1.0) < options.outlier_ratio;
    scene.points.push_back(scene.camera_from_world.Inverse() * in_camera);
    scene.bearings.push_back(is_outlier ? random->Bearing()
                                        : random->Noisy(in_camera.normalized(), options.sigma));
    scene.is_outlier.push_back(is_outlier);
  }
  return scene;
}

double RotationError(const Rigid3& a, const Rigid3& b) {
  return LogSo3(a.rotation.conjugate() * b.rotation).norm();
}
double CenterError(const Rigid3& a, const Rigid3& b) {
  return (a.Inverse().translation - b.Inverse().translation).norm();
}

TEST(EstimateAbsolutePose, RecoversExactBearingsFromPointsAllAround) {
  RandomGeometry random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Scene scene = MakeScene({}, &random);
    const auto found = EstimateAbsolutePose(scene.points, scene.bearings);
    ASSERT_TRUE(found);
    EXPECT_LT(RotationError(found->camera_from_world, scene.camera_from_world), 1e-9);
    EXPECT_LT(CenterError(found->camera_from_world, scene.camera_from_world), 1e-9);
    EXPECT_EQ(found->num_inliers, 200);
  }
}

TEST(EstimateAbsolutePose, RecoversFromPointsOnAnySideOnly) {
  RandomGeometry random(2);
  for (const Vector3d& towards : {Vector3d(-1, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0),
                                  Vector3d(0, -1, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
    const Scene scene = MakeScene({.towards = towards, .half_angle = 0.5}, &random);
    const auto found = EstimateAbsolutePose(scene.points, scene.bearings);
    ASSERT_TRUE(found);
    EXPECT_LT(RotationError(found->camera_from_world, scene.camera_from_world), 1e-9);
    EXPECT_LT(CenterError(found->camera_from_world, scene.camera_from_world), 1e-8);
  }
}

TEST(EstimateAbsolutePose, ErrorStaysWithinWhatTheNoisePredicts) {
  RandomGeometry random(3);
  constexpr double kSigma = 2e-3;
  for (const double outliers : {0.0, 0.3, 0.5}) {
    const Scene scene =
        MakeScene({.count = 500, .sigma = kSigma, .outlier_ratio = outliers}, &random);
    const auto found = EstimateAbsolutePose(scene.points, scene.bearings, {.sigma = kSigma});
    ASSERT_TRUE(found);
    // The information of the right bearings at the true pose, relative to the camera.
    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    int kept_outliers = 0, lost_inliers = 0;
    for (size_t i = 0; i < scene.points.size(); ++i) {
      kept_outliers += scene.is_outlier[i] && found->inliers[i];
      lost_inliers += !scene.is_outlier[i] && !found->inliers[i];
      if (scene.is_outlier[i]) continue;
      const Vector3d p = scene.camera_from_world * scene.points[i];
      Eigen::Matrix<double, 3, 6> motion;
      motion << -Skew(p), Eigen::Matrix3d::Identity();
      const Eigen::Matrix<double, 2, 6> jacobian =
          TangentBasis(p.normalized()).transpose() * motion / (p.norm() * kSigma);
      information += jacobian.transpose() * jacobian;
    }
    const Rigid3 error = found->camera_from_world * scene.camera_from_world.Inverse();
    Eigen::Matrix<double, 6, 1> twist;
    twist << LogSo3(error.rotation), error.translation;
    // Chi-squared of 6 degrees of freedom: above 27 once in 7000.
    EXPECT_LT(twist.dot(information * twist), 27.0);
    EXPECT_LE(kept_outliers, 3);
    EXPECT_LE(lost_inliers, 0.03 * 500);  // beyond 3 sigma: 1.1 %
    EXPECT_EQ(found->num_inliers, std::count(found->inliers.begin(), found->inliers.end(), true));
  }
}

TEST(EstimateAbsolutePose, FindsFewRightMatchesAmongManyWrongOnesWhenTold) {
  RandomGeometry random(4);
  const Scene scene = MakeScene({.count = 300, .sigma = 1e-3, .outlier_ratio = 0.85}, &random);
  const auto found =
      EstimateAbsolutePose(scene.points, scene.bearings, {.sigma = 1e-3, .min_inlier_ratio = 0.1});
  ASSERT_TRUE(found);
  EXPECT_LT(RotationError(found->camera_from_world, scene.camera_from_world), 2e-3);
}

TEST(EstimateAbsolutePose, DoesNotTakeAPointForItsAntipode) {
  RandomGeometry random(5);
  Scene scene = MakeScene({}, &random);
  for (int i = 0; i < 80; ++i) scene.bearings[i] = -scene.bearings[i];
  const auto found = EstimateAbsolutePose(scene.points, scene.bearings);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->num_inliers, 120);
  EXPECT_FALSE(found->inliers[0]);
  EXPECT_LT(CenterError(found->camera_from_world, scene.camera_from_world), 1e-9);
}

TEST(EstimateAbsolutePose, WeighsEveryFeatureByItsOwnNoise) {
  RandomGeometry random(6);
  Scene scene = MakeScene({.count = 300, .sigma = 5e-4}, &random);
  std::vector<double> sigmas(300, 5e-4);
  for (int i = 0; i < 200; ++i) {
    scene.bearings[i] = random.Noisy(scene.bearings[i], 1e-2);
    sigmas[i] = 1e-2;
  }
  const auto found = EstimateAbsolutePose(scene.points, scene.bearings, sigmas);
  ASSERT_TRUE(found);
  EXPECT_GT(found->num_inliers, 0.96 * 300);
  // As the hundred fine ones tell it: each axis from two thirds of 200 tangent components.
  EXPECT_LT(RotationError(found->camera_from_world, scene.camera_from_world),
            5 * 5e-4 * std::sqrt(3 / (2.0 / 3.0 * 200)));
}

TEST(EstimateAbsolutePose, GivesTheSameTwice) {
  RandomGeometry random(7);
  const Scene scene = MakeScene({.sigma = 3e-3, .outlier_ratio = 0.4}, &random);
  const auto first = EstimateAbsolutePose(scene.points, scene.bearings);
  const auto second = EstimateAbsolutePose(scene.points, scene.bearings);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->camera_from_world.rotation.coeffs(),
            second->camera_from_world.rotation.coeffs());
  EXPECT_EQ(first->camera_from_world.translation, second->camera_from_world.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(EstimateAbsolutePose, GivesNothingWhereThereIsNothing) {
  RandomGeometry random(8);
  EXPECT_FALSE(EstimateAbsolutePose({}, {}));
  const Scene few = MakeScene({.count = 2}, &random);
  EXPECT_FALSE(EstimateAbsolutePose(few.points, few.bearings));
  const Scene noise = MakeScene({.count = 100, .outlier_ratio = 1.0}, &random);
  EXPECT_FALSE(EstimateAbsolutePose(noise.points, noise.bearings));
  const std::vector<Vector3d> nan(50, Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(EstimateAbsolutePose(nan, nan));
  EXPECT_THROW(EstimateAbsolutePose(few.points, {}), ContractError);
  EXPECT_THROW(EstimateAbsolutePose(few.points, few.bearings, std::vector{1.0}), ContractError);
}

TEST(EstimateAbsolutePose, SurvivesPointsThatDetermineNoPose) {
  // All points the same, or on one line: some finite pose or none.
  std::vector<Vector3d> points(50, Vector3d(1, 2, 3));
  std::vector<Vector3d> bearings(50, Vector3d(0, 0, 1));
  for (int on_a_line = 0; on_a_line < 2; ++on_a_line) {
    if (const auto found = EstimateAbsolutePose(points, bearings)) {
      EXPECT_TRUE(found->camera_from_world.translation.allFinite());
      EXPECT_TRUE(found->camera_from_world.rotation.coeffs().allFinite());
    }
    for (size_t i = 0; i < points.size(); ++i) {
      points[i] = Vector3d(1, static_cast<double>(i), 3);
      bearings[i] = points[i].normalized();
    }
  }
}

}  // namespace
}  // namespace orb360
