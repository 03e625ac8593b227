#include "slam/features/static_region.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace orb360 {
namespace {

// Blobs of several sizes.
cv::Mat Texture(int seed) {
  cv::Mat sum = cv::Mat::zeros(320, 640, CV_32F);
  cv::RNG random(seed);
  for (const double sigma : {2.0, 5.0, 12.0}) {
    cv::Mat noise(sum.size(), CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 60.0 * sigma);
    cv::GaussianBlur(noise, noise, {0, 0}, sigma, sigma, cv::BORDER_REPLICATE);
    sum += noise;
  }
  cv::Mat texture;
  sum.convertTo(texture, CV_8U, 0.5, 128.0);
  return texture;
}

cv::Mat Roll(const cv::Mat& image, int shift) {
  if (shift == 0) return image.clone();
  cv::Mat rolled;
  cv::hconcat(image.colRange(shift, image.cols), image.colRange(0, shift), rolled);
  return rolled;
}

// A turning world with, optionally, a textured body fixed in front of the camera.
cv::Mat MaskOf(int shift_per_frame, const cv::Mat& body, int frames = 12) {
  const cv::Mat world = Texture(1);
  const cv::Mat carrier = Texture(2);
  StaticRegionDetector detector;
  for (int i = 0; i < frames; ++i) {
    cv::Mat image = Roll(world, i * shift_per_frame);
    if (!body.empty()) carrier.copyTo(image, body);
    detector.Add(image);
  }
  return detector.Mask({640, 320});
}

cv::Mat Body() {
  cv::Mat body = cv::Mat::zeros(320, 640, CV_8U);
  cv::ellipse(body, {300, 290}, {150, 60}, 0, 0, 360, 255, cv::FILLED);
  return body;
}

TEST(StaticRegion, FindsABodyThatMovesWithTheCamera) {
  const cv::Mat body = Body();
  const cv::Mat hidden = MaskOf(6, body) == 0;
  const double both = cv::countNonZero(hidden & body);
  const double either = cv::countNonZero(hidden | body);
  EXPECT_GT(both / either, 0.7);
}

TEST(StaticRegion, FindsABodyAcrossTheSeam) {
  const cv::Mat body = Roll(Body(), 300);
  const cv::Mat hidden = MaskOf(6, body) == 0;
  EXPECT_GT(cv::countNonZero(hidden & body) / static_cast<double>(cv::countNonZero(hidden | body)),
            0.7);
}

TEST(StaticRegion, MasksNothingWhereEverythingMoves) {
  EXPECT_EQ(cv::countNonZero(MaskOf(6, {}) == 0), 0);
}

TEST(StaticRegion, MasksNothingWhileTheCameraStandsStill) {
  EXPECT_EQ(cv::countNonZero(MaskOf(0, Body()) == 0), 0);
}

TEST(StaticRegion, SaysWhetherThereIsEvidence) {
  StaticRegionDetector detector;
  const cv::Mat world = Texture(1);
  detector.Add(world);
  EXPECT_FALSE(detector.HasEvidence());
  for (int i = 1; i < 12; ++i) detector.Add(Roll(world, 6 * i));
  EXPECT_TRUE(detector.HasEvidence());
}

TEST(StaticRegion, MasksBlackAreasAnywhere) {
  const cv::Mat world = Texture(1);
  StaticRegionDetector detector;
  for (int i = 0; i < 12; ++i) {
    cv::Mat image = Roll(world, 6 * i);
    image(cv::Rect(400, 20, 100, 60)).setTo(3);
    detector.Add(image);
  }
  const cv::Mat mask = detector.Mask({640, 320});
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(405, 25, 90, 50))), 0);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(0, 0, 380, 320)) == 0), 0);
}

}  // namespace
}  // namespace orb360
