#include <algorithm>

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/features/sphere_grid.h>

namespace orb360 {
namespace {

TEST(SphereGrid, FindsEveryBearingWithinTheRadiusPolesAndSeamIncluded) {
  RandomGeometry random(1);
  std::vector<Eigen::Vector3d> bearings;
  for (int i = 0; i < 3000; ++i) bearings.push_back(random.Bearing());
  bearings.push_back(Eigen::Vector3d::UnitZ());
  bearings.push_back(-Eigen::Vector3d::UnitZ());
  const SphereGrid grid(bearings);
  std::vector<Eigen::Vector3d> centers = {Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ(),
                                          Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()};
  for (int i = 0; i < 300; ++i) centers.push_back(random.Bearing());
  std::vector<int> found;
  for (const Eigen::Vector3d& center : centers) {
    for (const double radius : {0.01, 0.1, 0.5, 1.5, 3.1}) {
      found.clear();
      grid.Query(center, radius, &found);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "twice";
      for (size_t i = 0; i < bearings.size(); ++i) {
        if (AngleBetween(center, bearings[i]) > radius) continue;
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), static_cast<int>(i)))
            << "radius " << radius << " center " << center.transpose();
      }
    }
  }
}

TEST(SphereGrid, LooksAtLittleMoreThanItMust) {
  RandomGeometry random(2);
  std::vector<Eigen::Vector3d> bearings;
  for (int i = 0; i < 20000; ++i) bearings.push_back(random.Bearing());
  const SphereGrid grid(bearings);
  size_t found = 0;
  std::vector<int> indices;
  for (int i = 0; i < 100; ++i) {
    indices.clear();
    grid.Query(random.Bearing(), 0.05, &indices);
    found += indices.size();
  }
  // A cap of 0.05 rad lies in at most 3 x 3 cells of 4 degrees: 1 % of the sphere in the mean.
  EXPECT_LT(static_cast<double>(found) / 100, 0.01 * 20000);
}

TEST(SphereGrid, IsEmptyWithoutBearings) {
  std::vector<int> found;
  SphereGrid(std::vector<Eigen::Vector3d>{}).Query(Eigen::Vector3d::UnitX(), 0.5, &found);
  SphereGrid().Query(Eigen::Vector3d::UnitX(), 0.5, &found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace orb360
