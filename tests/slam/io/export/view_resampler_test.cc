#include "slam/io/export/view_resampler.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const cv::Size kSize(512, 256);

/// A colour that changes smoothly with the direction, everywhere on the sphere.
cv::Vec3b ColorOf(const Eigen::Vector3d& direction) {
  cv::Vec3b color;
  for (int c = 0; c < 3; ++c) {
    color[c] = static_cast<uint8_t>(std::lround(127.5 + 120 * direction(c)));
  }
  return color;
}

/// A panorama of these colours, by the definition of its pixels in the optical frame.
cv::Mat Panorama() {
  cv::Mat panorama(kSize, CV_8UC3);
  for (int row = 0; row < kSize.height; ++row) {
    for (int column = 0; column < kSize.width; ++column) {
      const double longitude = 2 * std::numbers::pi * ((column + 0.5) / kSize.width - 0.5);
      const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / kSize.height);
      panorama.at<cv::Vec3b>(row, column) =
          ColorOf({std::cos(latitude) * std::sin(longitude), -std::sin(latitude),
                   std::cos(latitude) * std::cos(longitude)});
    }
  }
  return panorama;
}

void ExpectColorsOfDirections(const cv::Mat& image, const View& view, int tolerance) {
  ASSERT_EQ(image.size(), cv::Size(view.width, view.height));
  int worst = 0;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const cv::Vec3b expected = ColorOf(DirectionOfPixel(view, {column + 0.5, row + 0.5}));
      for (int c = 0; c < 3; ++c) {
        worst = std::max(worst, std::abs(image.at<cv::Vec3b>(row, column)[c] - expected[c]));
      }
    }
  }
  EXPECT_LE(worst, tolerance) << view.name;
}

// Seams and poles included: a wrong continuation there would be wrong by much more.
TEST(ViewResampler, EachPixelOfAFaceShowsItsDirection) {
  const ViewResampler resampler(kSize, CubeViews(kSize.width, 96 * kDegree));
  const cv::Mat panorama = Panorama();
  for (size_t v = 0; v < resampler.views().size(); ++v) {
    ExpectColorsOfDirections(resampler.Resample(panorama, v), resampler.views()[v], 1);
    // Within half a pixel, by which colours change by 120 * pi / 512.
    ExpectColorsOfDirections(resampler.ResampleNearest(panorama, v), resampler.views()[v], 2);
  }
}

TEST(ViewResampler, AMaskOfAnotherSizeIsTakenAsThePartOfTheSphereThatItCovers) {
  const ViewResampler resampler(kSize, CubeViews(kSize.width, 96 * kDegree));
  cv::Mat mask(64, 128, CV_8UC1, cv::Scalar(255));
  mask.rowRange(32, 64).setTo(0);  // below the horizon
  const cv::Mat front = resampler.ResampleNearest(mask, 0);
  EXPECT_EQ(cv::countNonZero(front.rowRange(0, front.rows / 2)), front.cols * front.rows / 2);
  EXPECT_EQ(cv::countNonZero(front.rowRange(front.rows / 2, front.rows)), 0);
  EXPECT_EQ(cv::countNonZero(resampler.ResampleNearest(mask, 5)), 0);
}

TEST(ViewResampler, ThePanoramaStaysAsItIs) {
  const ViewResampler resampler(kSize, PanoramaView(kSize.width, kSize.height));
  const cv::Mat panorama = Panorama();
  EXPECT_EQ(cv::norm(resampler.Resample(panorama, 0), panorama, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace orb360
