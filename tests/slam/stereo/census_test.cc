#include "slam/stereo/census.h"

#include <bit>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

cv::Mat Noise(int seed) {
  cv::Mat gray(12, 16, CV_8U);
  cv::RNG(static_cast<uint64_t>(seed)).fill(gray, cv::RNG::UNIFORM, 10, 100);
  return gray;
}

TEST(TransformCensus, HasABitForEachNeighbourThatIsDarker) {
  cv::Mat gray(8, 8, CV_8U, cv::Scalar(50));
  gray.at<uint8_t>(4, 4) = 60;
  const CensusImage census = TransformCensus(gray);
  EXPECT_EQ(std::popcount(census.row(4)[4]), kCensusBits);
  EXPECT_EQ(census.row(4)[5], 0u) << "a brighter neighbour is no bit";
  gray.at<uint8_t>(4, 4) = 40;
  EXPECT_EQ(std::popcount(TransformCensus(gray).row(4)[5]), 1);
  EXPECT_EQ(std::popcount(TransformCensus(gray).row(4)[7]), 0) << "outside the window";
}

TEST(TransformCensus, DoesNotChangeWithTheExposure) {
  const cv::Mat gray = Noise(1);
  EXPECT_EQ(TransformCensus(gray).signatures, TransformCensus(2 * gray + 7).signatures);
}

TEST(TransformCensus, WrapsRowsAround) {
  const cv::Mat gray = Noise(2);
  cv::Mat turned;
  cv::vconcat(gray.rowRange(5, 12), gray.rowRange(0, 5), turned);
  const CensusImage census = TransformCensus(gray);
  const CensusImage of_turned = TransformCensus(turned, 2);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      EXPECT_EQ(of_turned.row(y)[x], census.row((y + 5) % 12)[x]) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace orb360
