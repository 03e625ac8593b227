#include <numbers>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(So3, SkewTimesVectorIsTheCrossProduct) {
  RandomGeometry random(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3d a = random.Point(0.1, 10.0);
    const Vector3d b = random.Point(0.1, 10.0);
    EXPECT_LT((Skew(a) * b - a.cross(b)).norm(), 1e-13);
  }
}

TEST(So3, ExpRotatesByTheAngleAboutTheAxis) {
  RandomGeometry random(2);
  for (const double angle : {0.0, 1e-300, 1e-12, 0.99e-8, 1.01e-8, 1e-4, 0.5, 3.0, 6.0, 20.0}) {
    const Vector3d axis = random.Bearing();
    const Quaterniond q = ExpSo3(angle * axis);
    EXPECT_NEAR(q.norm(), 1.0, 1e-15) << angle;
    const Vector3d perpendicular = axis.unitOrthogonal();
    const Vector3d expected =
        std::cos(angle) * perpendicular + std::sin(angle) * axis.cross(perpendicular);
    EXPECT_LT((q * perpendicular - expected).norm(), 1e-14) << angle;
    EXPECT_LT((q * axis - axis).norm(), 1e-15) << angle;
  }
}

TEST(So3, LogInvertsExpForEveryAngleUpToPi) {
  RandomGeometry random(3);
  constexpr double kPi = std::numbers::pi;
  for (const double angle : {0.0, 1e-300, 1e-20, 1e-13, 1e-11, 1e-9, 1e-7, 1e-3, 1.0, 2.0, 3.0,
                             kPi - 1e-3, kPi - 1e-8}) {
    const Vector3d omega = angle * random.Bearing();
    EXPECT_LE((LogSo3(ExpSo3(omega)) - omega).norm(), 4e-16 + 4e-15 * angle) << angle;
  }
}

TEST(So3, LogOfTinyRotationsKeepsItsRelativePrecision) {
  for (const double angle : {1e-15, 1e-12, 1e-10, 1e-8, 1e-6}) {
    const Vector3d omega(0.0, 0.6 * angle, -0.8 * angle);
    EXPECT_LT((LogSo3(ExpSo3(omega)) - omega).norm(), 1e-14 * angle) << angle;
  }
}

TEST(So3, LogTakesBothSignsOfTheQuaternionForTheSameRotation) {
  RandomGeometry random(4);
  for (int i = 0; i < 100; ++i) {
    const Quaterniond q = random.Rotation();
    const Quaterniond minus(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_LT((LogSo3(q) - LogSo3(minus)).norm(), 1e-14);
    EXPECT_LE(LogSo3(q).norm(), std::numbers::pi + 1e-15);
  }
}

TEST(So3, LogOfMoreThanHalfATurnIsTheShorterWayBack) {
  const Vector3d axis = Vector3d(1, -2, 3).normalized();
  const Vector3d log = LogSo3(ExpSo3(4.0 * axis));
  EXPECT_LT((log + (2.0 * std::numbers::pi - 4.0) * axis).norm(), 1e-14);
}

}  // namespace
}  // namespace orb360
