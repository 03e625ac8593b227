#include "slam/stereo/census.h"

#include <bit>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"

namespace orb360 {
namespace {

cv::Mat Noise(int seed) {
  cv::Mat gray(12, 70, CV_8U);
  cv::RNG(static_cast<uint64_t>(seed)).fill(gray, cv::RNG::UNIFORM, 10, 100);
  return gray;
}

CensusImage Transform(const cv::Mat& gray) {
  return TransformCensus(gray, cv::Mat::zeros(gray.size(), CV_8U));
}

uint32_t Signature(const CensusImage& census, int x, int y) {
  uint32_t bits = 0;
  for (const auto& plane : census.planes) bits = bits << 8 | plane[census.StartOf(y) + x];
  return bits;
}

TEST(TransformCensus, HasABitForEachNeighbourThatIsDarkerOnEveryInstructionSet) {
  ForEachDispatchTarget([] {
    cv::Mat gray(8, 70, CV_8U, cv::Scalar(50));
    gray.at<uint8_t>(4, 60) = 60;
    const CensusImage census = Transform(gray);
    EXPECT_EQ(std::popcount(Signature(census, 60, 4)), kCensusBits);
    EXPECT_EQ(Signature(census, 61, 4), 0u) << "a brighter neighbour is no bit";
    gray.at<uint8_t>(4, 60) = 40;
    EXPECT_EQ(std::popcount(Signature(Transform(gray), 61, 4)), 1);
    EXPECT_EQ(std::popcount(Signature(Transform(gray), 63, 4)), 0) << "outside the window";
  });
}

TEST(TransformCensus, DoesNotChangeWithTheExposure) {
  const cv::Mat gray = Noise(1);
  EXPECT_EQ(Transform(gray).planes, Transform(2 * gray + 7).planes);
}

TEST(TransformCensus, WrapsRowsAround) {
  const cv::Mat gray = Noise(2);
  cv::Mat turned;
  cv::vconcat(gray.rowRange(5, 12), gray.rowRange(0, 5), turned);
  const CensusImage census = Transform(gray);
  const CensusImage of_turned = Transform(turned);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      EXPECT_EQ(Signature(of_turned, x, y), Signature(census, x, (y + 5) % 12)) << x << ", " << y;
    }
  }
}

TEST(TransformCensus, AMatchOutsideTheImageCostsAllBits) {
  cv::Mat is_outside = cv::Mat::zeros(12, 70, CV_8U);
  is_outside.at<uint8_t>(3, 20) = 255;
  const CensusImage census = TransformCensus(Noise(3), is_outside);
  const uint8_t* least = &census.least_cost[census.StartOf(3)];
  EXPECT_EQ(least[20], kCensusBits);
  EXPECT_EQ(least[21], 0);
  EXPECT_EQ(least[-1], kCensusBits);
  EXPECT_EQ(least[70], kCensusBits);
}

}  // namespace
}  // namespace orb360
