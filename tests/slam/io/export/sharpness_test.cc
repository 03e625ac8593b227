#include "slam/io/export/sharpness.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace orb360 {
namespace {

cv::Mat Texture(cv::Size size) {
  cv::Mat noise(size.height / 4, size.width / 4, CV_8UC3);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::Mat texture;
  cv::resize(noise, texture, size, 0, 0, cv::INTER_CUBIC);
  return texture;
}

/// Blurred by a motion of so many pixels to the side.
cv::Mat Moved(const cv::Mat& image, int pixels) {
  cv::Mat moved;
  cv::blur(image, moved, {pixels, 1});
  return moved;
}

TEST(Sharpness, FallsWithTheLengthOfTheMotion) {
  for (const cv::Size size : {cv::Size(1024, 512), cv::Size(4096, 2048)}) {
    const cv::Mat texture = Texture(size);
    double before = MeasureSharpness(texture, {});
    for (const int pixels : {5, 9, 17}) {
      const double now = MeasureSharpness(Moved(texture, pixels), {});
      EXPECT_LT(now, 0.8 * before) << pixels << " of " << size;
      before = now;
    }
  }
}

TEST(Sharpness, AUniformImageHasNone) {
  EXPECT_EQ(MeasureSharpness(cv::Mat(256, 512, CV_8UC3, cv::Scalar(9, 99, 199)), {}), 0.0);
}

TEST(Sharpness, WhatTheMaskExcludesDoesNotCount) {
  cv::Mat image(256, 512, CV_8UC3, cv::Scalar::all(100));
  Texture({512, 128}).copyTo(image.rowRange(128, 256));  // such as the car that carries the camera
  cv::Mat mask(128, 256, CV_8UC1, cv::Scalar(255));
  mask.rowRange(63, 128).setTo(0);
  EXPECT_GT(MeasureSharpness(image, {}), 5.0);
  EXPECT_EQ(MeasureSharpness(image, mask), 0.0);
  mask.setTo(0);
  EXPECT_EQ(MeasureSharpness(image, mask), 0.0);
}

}  // namespace
}  // namespace orb360
