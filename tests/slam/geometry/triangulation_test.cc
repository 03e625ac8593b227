#include "slam/geometry/triangulation.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Vector3d;

struct Observations {
  std::vector<Rigid3> camera_from_world;
  std::vector<Vector3d> bearings;
};

/// `count` cameras turned anyhow within `spread` of the origin, all of which see the point.
Observations Observe(const Vector3d& point, int count, double spread, double sigma,
                     RandomGeometry* random) {
  Observations views;
  for (int i = 0; i < count; ++i) {
    const Rigid3 world_from_camera{random->Rotation(), random->Point(0.1 * spread, spread)};
    views.camera_from_world.push_back(world_from_camera.Inverse());
    views.bearings.push_back(
        random->Noisy((views.camera_from_world.back() * point).normalized(), sigma));
  }
  return views;
}

/// Sum of squared angular reprojection errors.
double Cost(const Observations& views, const Vector3d& point) {
  double cost = 0.0;
  for (size_t i = 0; i < views.bearings.size(); ++i) {
    cost += std::pow(ReprojectionAngle(views.camera_from_world[i], point, views.bearings[i]), 2);
  }
  return cost;
}

TEST(Triangulate, RecoversPointsInEveryDirectionFromAnyNumberOfViews) {
  RandomGeometry random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3d point = random.Point(2.0, 20.0);
    const Observations views = Observe(point, 2 + trial % 6, 1.0, 0.0, &random);
    const auto found = Triangulate(views.camera_from_world, views.bearings);
    ASSERT_TRUE(found);
    // Two views may be badly placed: the error grows as rounding / parallax^2.
    const double parallax =
        std::sin(ParallaxAngle(point, views.camera_from_world[0].Inverse().translation,
                               views.camera_from_world[1].Inverse().translation));
    EXPECT_LT((*found - point).norm(), 1e-13 * point.norm() / std::min(0.01, parallax * parallax));
  }
}

TEST(Triangulate, KeepsItsDigitsFarFromTheOrigin) {
  const Vector3d origin(4e5, -5e6, 100);  // metres, as of a map in UTM coordinates
  const Vector3d point = origin + Vector3d(3, 4, 0);
  std::vector<Rigid3> cameras;
  std::vector<Vector3d> bearings;
  for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 0, 1)}) {
    cameras.push_back({Eigen::Quaterniond::Identity(), -(origin + offset)});
    bearings.push_back((Vector3d(3, 4, 0) - offset).normalized());
  }
  const auto found = Triangulate(cameras, bearings);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - point).norm(), 2e-9);
}

TEST(Triangulate, MinimizesTheAngularErrorOfNoisyBearings) {
  RandomGeometry random(2);
  constexpr double kSigma = 1e-3;
  constexpr double kStep = 1e-4;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d point = random.Point(1.5, 6.0);
    const Observations views = Observe(point, 6, 1.0, kSigma, &random);
    const auto found = Triangulate(views.camera_from_world, views.bearings);
    ASSERT_TRUE(found);
    const double cost = Cost(views, *found);
    for (int axis = 0; axis < 3; ++axis) {
      // Central differences: the quadratic's minimum along the axis lies within a small part of
      // the noise's own displacement.
      const Vector3d step = kStep * Vector3d::Unit(axis);
      const double plus = Cost(views, *found + step), minus = Cost(views, *found - step);
      const double curvature = (plus + minus - 2.0 * cost) / (kStep * kStep);
      const double offset = kStep * (minus - plus) / (2.0 * (plus + minus - 2.0 * cost));
      EXPECT_LT(std::abs(offset), 0.05 * kSigma * std::sqrt(2.0 / curvature)) << trial;
    }
  }
}

TEST(Triangulate, ErrorStaysWithinWhatTheNoisePredicts) {
  RandomGeometry random(3);
  constexpr double kSigma = 1e-3;
  double squared = 0.0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector3d point = random.Point(1.5, 6.0);
    const Observations views = Observe(point, 5, 1.0, kSigma, &random);
    const auto found = Triangulate(views.camera_from_world, views.bearings);
    ASSERT_TRUE(found);
    // Information of a bearing: (I - d d^T) / (sigma range)^2; the normalized error has 3 degrees
    // of freedom.
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const Rigid3& camera : views.camera_from_world) {
      const Vector3d offset = point - camera.Inverse().translation;
      const Vector3d ray = offset.normalized();
      information += (Eigen::Matrix3d::Identity() - ray * ray.transpose()) /
                     (kSigma * kSigma * offset.squaredNorm());
    }
    squared += (*found - point).dot(information * (*found - point));
  }
  // Standard deviation of the mean of `kTrials` chi-squared variables: sqrt(6 / kTrials).
  EXPECT_NEAR(squared / kTrials, 3.0, 4.0 * std::sqrt(6.0 / kTrials));
}

TEST(Triangulate, RefusesWhatHasNoPoint) {
  const Rigid3 here;
  const Rigid3 right{Eigen::Quaterniond::Identity(), Vector3d(0, -1, 0)};  // centre at y = 1
  const Vector3d forward(-1, 0, 0);
  EXPECT_FALSE(Triangulate({}, {}));
  EXPECT_FALSE(Triangulate(std::vector{here}, std::vector{forward}));
  EXPECT_FALSE(Triangulate(std::vector{here, right}, std::vector{forward, forward}));  // parallel
  EXPECT_FALSE(
      Triangulate(std::vector{here, here},
                  std::vector{forward, Vector3d(-1, 0.1, 0).normalized()}));  // no baseline
  // Diverging: the lines meet behind both cameras.
  EXPECT_FALSE(Triangulate(
      std::vector{here, right},
      std::vector{Vector3d(-1, -0.1, 0).normalized(), Vector3d(-1, 0.1, 0).normalized()}));
  EXPECT_THROW(Triangulate(std::vector{here}, {}), ContractError);
}

TEST(TriangulateTwoViews, RecoversPointsOverTheWholeSphereForEveryMotion) {
  RandomGeometry random(4);
  for (const Vector3d& motion : {Vector3d(-1, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0),
                                 Vector3d(0, -1, 0), Vector3d(0, 0, 1), Vector3d(-1, 2, 3)}) {
    for (int trial = 0; trial < 300; ++trial) {
      const Rigid3 camera1_from_camera2{random.Rotation(), motion};
      const Vector3d point = random.Point(0.3, 20.0);
      const Vector3d in_camera2 = camera1_from_camera2.Inverse() * point;
      const auto found =
          TriangulateTwoViews(camera1_from_camera2, point.normalized(), in_camera2.normalized());
      const double sine = std::sin(ParallaxAngle(point, Vector3d::Zero(), motion));
      if (sine < 1e-4) continue;
      ASSERT_TRUE(found);
      // The plane is ill defined in proportion to the closeness to the epipole, the range to the
      // parallax; both within a factor of sine.
      EXPECT_LT((*found - point).norm(), 1e-14 * point.norm() / (sine * sine) + 1e-14);
    }
  }
}

TEST(TriangulateTwoViews, IsTheLeastAngularErrorOfAllPoints) {
  RandomGeometry random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Rigid3 camera1_from_camera2{random.Rotation(), random.Bearing()};
    const Vector3d point = random.Point(1.5, 5.0);
    const double sigma1 = random.Uniform(1e-3, 4e-3), sigma2 = random.Uniform(1e-3, 4e-3);
    const Vector3d bearing1 = random.Noisy(point.normalized(), sigma1);
    const Vector3d bearing2 =
        random.Noisy((camera1_from_camera2.Inverse() * point).normalized(), sigma2);
    const auto found =
        TriangulateTwoViews(camera1_from_camera2, bearing1, bearing2, sigma1, sigma2);
    if (!found) continue;
    const auto cost = [&](const Vector3d& p) {
      return std::pow(std::sin(ReprojectionAngle(Rigid3(), p, bearing1)) / sigma1, 2) +
             std::pow(
                 std::sin(ReprojectionAngle(camera1_from_camera2.Inverse(), p, bearing2)) / sigma2,
                 2);
    };
    const double best = cost(*found);
    for (int other = 0; other < 100; ++other) {
      const double reach = std::pow(10.0, random.Uniform(-7.0, 0.0));
      EXPECT_GE(cost(*found + reach * random.Bearing()), best * (1.0 - 1e-9));
    }
  }
}

TEST(TriangulateTwoViews, AgreesWithTheLinearMethodOnNoisyBearings) {
  RandomGeometry random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d point = random.Point(1.5, 4.0);
    const Rigid3 camera2_from_camera1{random.Rotation(), random.Bearing()};
    const Rigid3 camera1_from_camera2 = camera2_from_camera1.Inverse();
    const double parallax =
        ParallaxAngle(point, Vector3d::Zero(), camera1_from_camera2.translation);
    if (parallax < 0.1 || parallax > 3.0) continue;
    const std::vector<Vector3d> bearings = {
        random.Noisy(point.normalized(), 1e-3),
        random.Noisy((camera2_from_camera1 * point).normalized(), 1e-3)};
    const auto optimal = TriangulateTwoViews(camera1_from_camera2, bearings[0], bearings[1]);
    const auto linear = Triangulate(std::vector{Rigid3(), camera2_from_camera1}, bearings);
    ASSERT_TRUE(optimal && linear);
    EXPECT_LT((*optimal - *linear).norm(), 1e-4 * point.norm() / parallax);
  }
}

TEST(TriangulateTwoViews, RefusesWhatHasNoPoint) {
  const Vector3d forward(-1, 0, 0);
  const Rigid3 right{Eigen::Quaterniond::Identity(), Vector3d(0, 1, 0)};
  EXPECT_FALSE(TriangulateTwoViews(Rigid3(), forward, forward));  // no baseline
  EXPECT_FALSE(TriangulateTwoViews(right, forward, forward));     // parallel
  const Vector3d to_left = Vector3d(-1, -0.1, 0).normalized();
  const Vector3d to_right = Vector3d(-1, 0.1, 0).normalized();
  EXPECT_FALSE(TriangulateTwoViews(right, to_left, to_right));  // diverging
  EXPECT_TRUE(TriangulateTwoViews(right, to_right, to_left));
  EXPECT_TRUE(TriangulateTwoViews(right, -to_left, -to_right));  // the same behind the cameras
  EXPECT_FALSE(TriangulateTwoViews(right, -to_right, to_left));  // behind one of them
  EXPECT_FALSE(TriangulateTwoViews(right, to_right, -to_left));
  const Vector3d epipole(0, 1, 0);
  EXPECT_FALSE(TriangulateTwoViews(right, epipole, epipole));
  EXPECT_FALSE(TriangulateTwoViews(right, epipole, -epipole));
}

TEST(Parallax, OfTheRaysIsThatOfThePoint) {
  RandomGeometry random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Rigid3 camera1_from_camera2{random.Rotation(), random.Bearing()};
    const Vector3d point = random.Point(0.5, 5.0);
    const Vector3d bearing2 = (camera1_from_camera2.Inverse() * point).normalized();
    EXPECT_NEAR(ParallaxCosine(camera1_from_camera2.rotation, point.normalized(), bearing2),
                std::cos(ParallaxAngle(point, Vector3d::Zero(), camera1_from_camera2.translation)),
                1e-14);
  }
}

TEST(ReprojectionAngle, IsTheAngleByWhichTheBearingIsTurned) {
  RandomGeometry random(8);
  for (int trial = 0; trial < 100; ++trial) {
    const Rigid3 camera_from_world = random.Transform();
    const Vector3d point = random.Point(0.5, 9.0);
    const Vector3d bearing = (camera_from_world * point).normalized();
    const double angle = random.Uniform(1e-6, 3.0);
    const Vector3d turned =
        std::cos(angle) * bearing + std::sin(angle) * TangentBasis(bearing).col(trial % 2);
    EXPECT_NEAR(ReprojectionAngle(camera_from_world, point, turned), angle, 1e-14);
    EXPECT_EQ(HasPositiveRange(camera_from_world, point, turned), angle < std::numbers::pi / 2);
  }
}

}  // namespace
}  // namespace orb360
