#include "slam/evaluation/cloud_image.h"

#include <vector>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

/// A path of 84 m to the east at a height of 2: the image is 104 m wide and 20 m high.
std::vector<Eigen::Vector3d> Path() {
  std::vector<Eigen::Vector3d> path;
  for (int i = 0; i <= 84; ++i) path.emplace_back(i, 0, 2);
  return path;
}

SurfacePoint At(float x, float y, float z, std::uint8_t grey) {
  return {{x, y, z}, {0, 0, 1}, {grey, grey, grey}, 1.0f};
}

TEST(CloudImage, ShowsTheHighestBelowTheCamera) {
  CloudImage cloud_image(Path(), 1000);
  const std::vector<SurfacePoint> points = {At(40, 5, 0.5f, 200), At(40, 5, 0, 90),
                                            At(40, 5, 2.5f, 30), At(500, 5, 0, 100)};
  cloud_image.Add(points);
  const cv::Mat image = cloud_image.Draw(/*is_metric=*/true);
  EXPECT_EQ(image.cols, 1000);
  std::vector<cv::Point> found;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const cv::Vec3b& pixel = image.at<cv::Vec3b>(row, column);
      EXPECT_NE(pixel, cv::Vec3b::all(90));
      EXPECT_NE(pixel, cv::Vec3b::all(30));
      if (pixel == cv::Vec3b::all(200)) found.emplace_back(column, row);
    }
  }
  ASSERT_EQ(found.size(), 1u);
  // 84 * 1.24 units wide: the margin is 12 % of the path.
  const double pixels_per_unit = 1000 / (84 * 1.24);
  EXPECT_NEAR(found[0].x, (40 + 84 * 0.12) * pixels_per_unit, 1.0);
  EXPECT_NEAR(found[0].y, (84 * 0.12 - 5) * pixels_per_unit, 1.0);
}

TEST(CloudImage, NamesAnotherUnitWhereTheCloudIsNotMetric) {
  const CloudImage image(Path(), 1000);
  EXPECT_GT(cv::norm(image.Draw(/*is_metric=*/true), image.Draw(/*is_metric=*/false)), 0);
}

TEST(CloudImage, SurvivesACameraThatStandsStill) {
  const std::vector<Eigen::Vector3d> path(3, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(CloudImage(path, 200).Draw(/*is_metric=*/true).size(), cv::Size(200, 200));
}

}  // namespace
}  // namespace orb360
