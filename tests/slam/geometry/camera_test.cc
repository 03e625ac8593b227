#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

using Eigen::Matrix;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

const EquirectangularCamera kCameras[] = {{2048, 1024}, {640, 322}, {7, 5}};

TEST(Camera, AxesAreWhereThePaperPutsThem) {
  const EquirectangularCamera camera(2048, 1024);
  EXPECT_LT((camera.Project(Vector3d(-1, 0, 0)) - Vector2d(1024, 512)).norm(), 1e-12);  // forward
  EXPECT_LT((camera.Project(Vector3d(0, 2, 0)) - Vector2d(1536, 512)).norm(), 1e-12);   // right
  EXPECT_LT((camera.Project(Vector3d(0, -2, 0)) - Vector2d(512, 512)).norm(), 1e-12);   // left
  EXPECT_DOUBLE_EQ(camera.Project(Vector3d(0, 0, 3)).y(), 0.0);                         // up
  EXPECT_DOUBLE_EQ(camera.Project(Vector3d(0, 0, -3)).y(), 1024.0);                     // down
  EXPECT_LT((camera.Project(Vector3d(-1, 1, std::sqrt(2.0))) - Vector2d(1280, 256)).norm(), 1e-12);
}

TEST(Camera, BehindIsTheSeamFromEitherSideAndZero) {
  const EquirectangularCamera camera(2048, 1024);
  EXPECT_EQ(camera.Project(Vector3d(1, 0.0, 0)).x(), 0.0);
  EXPECT_EQ(camera.Project(Vector3d(1, -0.0, 0)).x(), 0.0);
  EXPECT_NEAR(camera.Project(Vector3d(1, 1e-6, 0)).x(), 2048.0, 1e-3);
  EXPECT_NEAR(camera.Project(Vector3d(1, -1e-6, 0)).x(), 0.0, 1e-3);
  EXPECT_LT(camera.Project(Vector3d(1, 1e-300, 0)).x(), 2048.0);
}

TEST(Camera, ProjectOfBackProjectIsIdentityOverTheWholeSphere) {
  for (const EquirectangularCamera& camera : kCameras) {
    for (int row = 0; row <= 64; ++row) {
      for (int column = 0; column < 128; ++column) {
        // The rows closest to the poles are 1e-6 of the image away from them.
        const double v = camera.height() * std::clamp(row / 64.0, 1e-6, 1.0 - 1e-6);
        const Vector2d pixel(camera.width() * column / 128.0, v);
        const Vector3d point = camera.BackProject(pixel, 3.5);
        EXPECT_NEAR(point.norm(), 3.5, 1e-14);
        const Vector2d back = camera.Project(point);
        EXPECT_GE(back.x(), 0.0);
        EXPECT_LT(back.x(), camera.width());
        EXPECT_NEAR(camera.WrapDeltaU(back.x() - pixel.x()), 0.0, 1e-9 * camera.width());
        EXPECT_NEAR(back.y(), pixel.y(), 1e-12 * camera.height());
      }
    }
  }
}

TEST(Camera, BackProjectOfProjectIsIdentityForEveryDirection) {
  RandomGeometry random(1);
  for (const EquirectangularCamera& camera : kCameras) {
    for (int i = 0; i < 1000; ++i) {
      const Vector3d point = random.Point(1e-3, 1e3);
      EXPECT_LT((camera.BackProject(camera.Project(point), point.norm()) - point).norm(),
                1e-14 * point.norm());
    }
    for (const Vector3d& pole : {Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
      EXPECT_LT((camera.Bearing(camera.Project(pole)) - pole).norm(), 1e-15);
    }
  }
}

TEST(Camera, BearingIsPeriodicInU) {
  const EquirectangularCamera camera(640, 322);
  for (const double u : {-320.0, -0.25, 0.0, 639.5, 640.0, 900.0}) {
    const Vector3d inside = camera.Bearing({camera.WrapU(u), 100.25});
    EXPECT_LT((camera.Bearing({u, 100.25}) - inside).norm(), 1e-14);
  }
}

TEST(Camera, JacobianIsThatOfCentralDifferencesOverTheWholeSphere) {
  RandomGeometry random(2);
  std::vector<Vector3d> bearings = {{1, 1e-12, 0},     {1, -1e-12, 0}, {1, 0, 0},   {-1, 0, 0},
                                    {0, 1, 0},         {0, -1, 0},     {1, 0, 0.5}, {0.01, 0.01, 1},
                                    {-0.01, 0.02, -1}, {1e-3, 0, 1}};
  for (int i = 0; i < 500; ++i) bearings.push_back(random.Bearing());
  for (const EquirectangularCamera& camera : kCameras) {
    for (const Vector3d& bearing : bearings) {
      const Vector3d point = 2.5 * bearing.normalized();
      Vector2d pixel;
      Matrix<double, 2, 3> jacobian;
      ASSERT_TRUE(camera.Project(point, &pixel, &jacobian));
      EXPECT_EQ(pixel, camera.Project(point));
      // The third derivatives grow as 1/h^3, h the distance from the polar axis.
      const double h = point.head<2>().norm();
      const double step = 1e-5 * h;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d offset = step * Vector3d::Unit(axis);
        Vector2d difference = camera.Project(point + offset) - camera.Project(point - offset);
        difference.x() = camera.WrapDeltaU(difference.x());
        EXPECT_LT((difference / (2.0 * step) - jacobian.col(axis)).norm(),
                  1e-9 * camera.width() / h + 1e-12 * camera.width() / step)
            << point.transpose() << " axis " << axis;
      }
    }
  }
}

TEST(Camera, JacobianIsRefusedWhereItDoesNotExistAndOutputsStay) {
  const EquirectangularCamera camera(2048, 1024);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3d& point :
       {Vector3d(0, 0, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -7), Vector3d(1e-10, 0, 1),
        Vector3d(kNan, 0, 0), Vector3d(1, 0, kNan)}) {
    Vector2d pixel(-1, -2);
    Matrix<double, 2, 3> jacobian = Matrix<double, 2, 3>::Constant(7.0);
    EXPECT_FALSE(camera.Project(point, &pixel, &jacobian)) << point.transpose();
    EXPECT_EQ(pixel, Vector2d(-1, -2));
    EXPECT_EQ(jacobian, (Matrix<double, 2, 3>::Constant(7.0)));
  }
}

TEST(Camera, WrapUIsPeriodicAndStaysInside) {
  const EquirectangularCamera camera(640, 320);
  EXPECT_EQ(camera.WrapU(0.0), 0.0);
  EXPECT_EQ(camera.WrapU(640.0), 0.0);
  EXPECT_EQ(camera.WrapU(-1.0), 639.0);
  EXPECT_EQ(camera.WrapU(641.5), 1.5);
  EXPECT_EQ(camera.WrapU(-1281.0), 639.0);
  EXPECT_EQ(camera.WrapU(-1e-20), 0.0);
  EXPECT_LT(camera.WrapU(std::nextafter(640.0, 0.0)), 640.0);
}

TEST(Camera, WrapDeltaUIsTheShorterWayAroundTheSeam) {
  const EquirectangularCamera camera(640, 320);
  EXPECT_EQ(camera.WrapDeltaU(639.0), -1.0);
  EXPECT_EQ(camera.WrapDeltaU(-639.0), 1.0);
  EXPECT_EQ(camera.WrapDeltaU(319.0), 319.0);
  EXPECT_EQ(camera.WrapDeltaU(320.0), -320.0);
  EXPECT_EQ(camera.WrapDeltaU(-320.0), -320.0);
  EXPECT_EQ(camera.WrapDeltaU(1280.25), 0.25);
}

TEST(Camera, APixelAtTheEquatorSpansItsAngle) {
  const EquirectangularCamera camera(2048, 1024);
  EXPECT_DOUBLE_EQ(camera.AngleOfPixels(2048), 2.0 * kPi);
  const Vector3d a = camera.Bearing({100.5, 512});
  const Vector3d b = camera.Bearing({101.5, 512});
  EXPECT_NEAR(std::acos(a.dot(b)), camera.AngleOfPixels(1.0), 1e-9);
}

TEST(Camera, RefusesSizesThatAreNotPositive) {
  EXPECT_THROW(EquirectangularCamera(0, 10), ContractError);
  EXPECT_THROW(EquirectangularCamera(10, -1), ContractError);
}

}  // namespace
}  // namespace orb360
