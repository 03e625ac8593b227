#include "slam/features/sphere_pyramid.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(SpherePyramid, MarginsContinueTheSphere) {
  cv::Mat image(256, 512, CV_8U);
  cv::randu(image, 0, 256);
  std::vector<PyramidLevel> levels;
  BuildSpherePyramid(image, 8, &levels);
  ASSERT_EQ(levels.size(), 8u);
  for (const PyramidLevel& level : levels) {
    const int width = level.camera.width();
    const int height = level.camera.height();
    const cv::Mat inner = level.image();
    for (int y = -PyramidLevel::kMarginY; y < height + PyramidLevel::kMarginY; ++y) {
      for (int x = -PyramidLevel::kMarginX; x < width + PyramidLevel::kMarginX; ++x) {
        // The same direction inside the image: beyond a pole at the opposite longitude.
        int inside_y = y;
        int inside_x = x;
        if (y < 0 || y >= height) {
          inside_y = y < 0 ? -1 - y : 2 * height - 1 - y;
          inside_x += width / 2;
        }
        inside_x = (inside_x % width + width) % width;
        ASSERT_EQ(level.padded.at<uint8_t>(y + PyramidLevel::kMarginY, x + PyramidLevel::kMarginX),
                  inner.at<uint8_t>(inside_y, inside_x))
            << x << ' ' << y << " of " << width;
      }
    }
  }
}

TEST(SpherePyramid, ScalesGrowByAFourthRootOfTwoInMultiplesOf32Columns) {
  std::vector<PyramidLevel> levels;
  BuildSpherePyramid(cv::Mat::zeros(1024, 2048, CV_8U), 8, &levels);
  ASSERT_EQ(levels.size(), 8u);
  for (size_t l = 0; l < levels.size(); ++l) {
    EXPECT_EQ(levels[l].camera.width() % 32, 0);
    EXPECT_NEAR(levels[l].scale, std::exp2(l / 4.0), 0.03 * levels[l].scale);
    EXPECT_NEAR(levels[l].scale * levels[l].camera.width(), 2048, 1e-9);
  }
}

TEST(SpherePyramid, ReusedMemoryGivesTheSamePyramid) {
  cv::Mat first(128, 256, CV_8U);
  cv::Mat second(128, 256, CV_8U);
  cv::randu(first, 0, 256);
  cv::randu(second, 0, 256);
  std::vector<PyramidLevel> reused;
  std::vector<PyramidLevel> fresh;
  BuildSpherePyramid(first, 6, &reused);
  BuildSpherePyramid(second, 6, &reused);
  BuildSpherePyramid(second, 6, &fresh);
  ASSERT_EQ(reused.size(), fresh.size());
  for (size_t l = 0; l < fresh.size(); ++l) {
    EXPECT_EQ(cv::norm(reused[l].padded, fresh[l].padded, cv::NORM_INF), 0.0);
  }
}

}  // namespace
}  // namespace orb360
