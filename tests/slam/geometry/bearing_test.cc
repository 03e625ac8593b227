#include "slam/geometry/bearing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

using Eigen::Vector3d;

TEST(AngleBetween, IsExactForTinyAndForObtuseAngles) {
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-3, 1.0, 3.0, std::numbers::pi - 1e-9}) {
    const Vector3d a(2, 0, 0);
    const Vector3d b(5 * std::cos(angle), 0, 5 * std::sin(angle));
    EXPECT_NEAR(AngleBetween(a, b), angle, 1e-15 + 1e-14 * std::min(angle, 1.0));
  }
}

TEST(TangentBasis, IsARightHandedFrameWithEveryBearing) {
  RandomGeometry random(1);
  std::vector<Vector3d> bearings = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0},    {-1, 0, 0},
                                    {0, 1, 0}, {0, -1, 0}, {1, 0, -0.0}, {1e-9, 0, -1}};
  for (int i = 0; i < 1000; ++i) bearings.push_back(random.Bearing());
  for (const Vector3d& bearing : bearings) {
    Eigen::Matrix3d frame;
    frame << TangentBasis(bearing), bearing;
    EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 2e-15)
        << bearing.transpose();
    EXPECT_NEAR(frame.determinant(), 1.0, 2e-15) << bearing.transpose();
  }
}

}  // namespace
}  // namespace orb360
