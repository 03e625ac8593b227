#include "slam/evaluation/cloud_error.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/range_room.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

/// The walls of a room, seen from two places.
std::vector<Surfel> Walls(const RangeRoom& room) {
  TrueSurface surface;
  for (const double x : {-1.0, 1.0}) {
    const Rigid3 camera = TurnedCamera({x, 0, 0}, x);
    surface.Add(room.Render({512, 256}, camera).range, {}, camera);
  }
  return surface.TakeSurfels();
}

/// Points on the wall x = 4, moved inward, every 4 cm; `height` of the wall is covered.
std::vector<Eigen::Vector3f> OnTheWall(double inward, double height) {
  std::vector<Eigen::Vector3f> points;
  for (double y = -2.8; y < 2.8; y += 0.04) {
    for (double z = -1.3; z < -1.3 + height; z += 0.04) {
      points.emplace_back(static_cast<float>(4.0 - inward), static_cast<float>(y),
                          static_cast<float>(z));
    }
  }
  return points;
}

TEST(TrueSurface, IsThinnedToOneDiscInACube) {
  const std::vector<Surfel> walls = Walls({});
  // 180 square metres in cubes of 5 cm; pixels of 1.2 to 6 cm leave few of them empty.
  EXPECT_GT(walls.size(), 0.5 * 180 * 400);
  EXPECT_LT(walls.size(), 1.4 * 180 * 400);
  for (const Surfel& surfel : walls) {
    EXPECT_LT(RangeRoom().DistanceFromWalls(surfel.position.cast<double>()), 1e-3);
    EXPECT_LE(surfel.radius, 0.15f);
  }
}

TEST(TrueSurface, LeavesOutWhatIsExcluded) {
  TrueSurface surface;
  const Rigid3 camera;
  cv::Mat excluded = cv::Mat::zeros(128, 256, CV_8U);
  excluded.rowRange(0, 64) = 255;  // above the horizon
  surface.Add(RangeRoom().Render({256, 128}, camera).range, excluded, camera);
  for (const Surfel& surfel : surface.TakeSurfels()) EXPECT_LT(surfel.position.z(), 0.0f);
}

const std::vector<Eigen::Vector3f> kCenter = {Eigen::Vector3f::Zero()};

TEST(CompareCloud, AccuracyIsTheDistanceFromTheSurfaceNotFromItsPixels) {
  const std::vector<Surfel> walls = Walls({});
  const auto errors = [&](double inward) {
    return CompareCloud(OnTheWall(inward, 2.6), walls, kCenter);
  };
  EXPECT_EQ(errors(0.0).within[0].accuracy, 1.0);
  EXPECT_LT(errors(0.0).median_distance, 1e-3);
  EXPECT_EQ(errors(0.09).within[1].accuracy, 1.0);
  EXPECT_LT(errors(0.09).within[0].accuracy, 0.15);  // The edges are near floor and ceiling.
  EXPECT_NEAR(errors(0.09).median_distance, 0.09, 2e-3);
  EXPECT_LT(errors(0.12).within[1].accuracy, 0.15);
  EXPECT_EQ(errors(0.12).within[2].accuracy, 1.0);
  EXPECT_LT(errors(0.30).within[2].accuracy, 0.3);
}

TEST(CompareCloud, CompletenessIsTheFractionOfTheSurface) {
  // Only the wall x = 4 is there to be covered.
  std::vector<Surfel> wall;
  for (const Surfel& surfel : Walls({})) {
    if (surfel.position.x() > 3.99f) wall.push_back(surfel);
  }
  const CloudErrors half = CompareCloud(OnTheWall(0.0, 1.5), wall, kCenter);
  EXPECT_NEAR(half.within[1].completeness, 0.54, 0.06);
  EXPECT_GT(half.within[2].completeness, half.within[1].completeness);
  const double completeness = half.within[1].completeness;
  EXPECT_NEAR(half.within[1].f_score, 2 * completeness / (1 + completeness), 1e-12);
  EXPECT_EQ(half.surfels, wall.size());
  EXPECT_EQ(CompareCloud(OnTheWall(0.3, 2.6), wall, kCenter).within[2].completeness, 0.0);
  EXPECT_EQ(CompareCloud({}, wall, kCenter).within[2].completeness, 0.0);
  EXPECT_TRUE(std::isnan(CompareCloud({}, wall, kCenter).within[1].accuracy));
}

TEST(CompareCloud, ComparesPointsByTheirDistanceFromTheCameras) {
  const std::vector<Surfel> walls = Walls({});
  const std::vector<Eigen::Vector3f> cloud = OnTheWall(0.06, 2.6);
  // From 24 m away 1 % of the range is four times the error, from 4 m less than it.
  const std::vector<Eigen::Vector3f> far = {{-20, 0, 0}};
  EXPECT_GT(CompareCloud(cloud, walls, far).within_relative.accuracy, 0.95);
  EXPECT_TRUE(std::isnan(CompareCloud(cloud, walls, far).within[1].accuracy));
  EXPECT_LT(CompareCloud(cloud, walls, kCenter).within_relative.accuracy, 0.2);
  const std::vector<Eigen::Vector3f> farther = {{-30, 0, 0}};
  EXPECT_EQ(CompareCloud(cloud, walls, farther).points, 0u);
}

TEST(AlignLocally, UndoesADriftThatGrowsAlongThePath) {
  std::vector<PosePair> pairs;
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3d> truth;
  for (int i = 0; i < 200; ++i) {
    const Rigid3 camera{ExpSo3({0, 0, 0.01 * i}), {0.5 * i, 0, 0}};
    const Rigid3 drift{ExpSo3({0, 0, 1e-4 * i}), {0, 0.01 * i, 0}};
    pairs.push_back({0.05 * i, camera, drift * camera});
    truth.emplace_back(0.5 * i, 2.0, 1.0);
    points.push_back((drift * truth.back()).cast<float>());
  }
  EXPECT_GT((points.back().cast<double>() - truth.back()).norm(), 2.0);
  AlignLocally(pairs, points);
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((points[i].cast<double>() - truth[i]).norm(), 0.05);
  }
}

}  // namespace
}  // namespace orb360
