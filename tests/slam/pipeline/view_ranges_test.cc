#include "slam/pipeline/view_ranges.h"

#include <cstdint>

#include <gtest/gtest.h>

#include "slam/io/depth_map_store.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kWidth = 32;
constexpr int kHeight = 16;

DenseDepth Completed(double confidence) {
  const cv::Size size(kWidth, kHeight);
  return {cv::Mat(size, CV_32F, cv::Scalar(3)), cv::Mat(size, CV_32F, cv::Scalar(confidence)),
          cv::Mat(size, CV_8UC3, cv::Scalar::all(0))};
}

RangeSource SourceAt(const DenseDepth& depth, int row, int column) {
  return static_cast<RangeSource>(depth.source.at<std::uint8_t>(row, column));
}

// Every second column, with the given standard deviation of ln(range).
InverseRanges EverySecondColumn(double sigma) {
  InverseRanges measured{cv::Mat::zeros(kHeight, kWidth, CV_32F),
                         cv::Mat::zeros(kHeight, kWidth, CV_32F)};
  for (int column = 0; column < kWidth; column += 2) {
    measured.value.col(column) = 0.25;
    measured.sigma.col(column) = 0.25 * sigma;
  }
  return measured;
}

TEST(ViewRanges, MeasuredAndCompletedOnesAreToldApartAfterTheyWereStored) {
  const TempFolder folder;
  const DepthMapStore store(folder / "depth");
  for (const double sigma : {0.001, InverseRangeFusionOptions().max_sigma}) {
    DenseDepth depth = Completed(1.0);  // The surest that a network can be.
    StateCompleted(1.0, &depth);
    const InverseRanges measured = EverySecondColumn(sigma);
    PutMeasured(measured, &depth);
    store.Put(0, depth);
    const InverseRanges restored = MeasuredOf(store.Get(0));
    for (int column = 0; column < kWidth; ++column) {
      const float value = restored.value.at<float>(5, column);
      EXPECT_NEAR(value, measured.value.at<float>(5, column), 0.0005 * value) << column;
      EXPECT_EQ(value > 0, column % 2 == 0) << column;
      EXPECT_NEAR(restored.sigma.at<float>(5, column), measured.sigma.at<float>(5, column), 0.001);
    }
  }
}

TEST(ViewRanges, ErrorsOfCompletedOnesAreMultiplied) {
  DenseDepth depth = Completed(0.8);  // An error of 0.25.
  StateCompleted(3.0, &depth);
  EXPECT_FLOAT_EQ(depth.confidence.at<float>(3, 3), 1 / 1.75F);
  EXPECT_EQ(SourceAt(depth, 3, 3), RangeSource::kCompleted);
  DenseDepth unknown = Completed(0);
  StateCompleted(3.0, &unknown);
  EXPECT_EQ(unknown.confidence.at<float>(3, 3), 0);
}

TEST(ViewRanges, AtBoundariesTheErrorIsAtLeastTheGivenOne) {
  DenseDepth depth = Completed(0.8);
  StateCompleted(1.0, &depth);
  depth.confidence.at<float>(3, 4) = 0.2F;
  cv::Mat mask = cv::Mat::zeros(depth.range.size(), CV_8U);
  mask(cv::Rect(3, 3, 2, 1)) = 255;
  StateBoundary(mask, 1.0, &depth);
  EXPECT_EQ(depth.confidence.at<float>(3, 3), 0.5F);
  EXPECT_EQ(depth.confidence.at<float>(3, 4), 0.2F);
  EXPECT_FLOAT_EQ(depth.confidence.at<float>(4, 3), 0.8F);
  EXPECT_EQ(SourceAt(depth, 3, 3), RangeSource::kBoundary);
  EXPECT_EQ(SourceAt(depth, 3, 4), RangeSource::kBoundary);
  EXPECT_EQ(SourceAt(depth, 4, 3), RangeSource::kCompleted);
  EXPECT_EQ(depth.range.at<float>(3, 3), 3);
}

TEST(ViewRanges, DepthWithoutSourcesIsRefused) {
  DenseDepth depth = Completed(0.8);
  EXPECT_THROW(PutMeasured(EverySecondColumn(0.05), &depth), ContractError);
  EXPECT_THROW(StateBoundary(cv::Mat::zeros(depth.range.size(), CV_8U), 1.0, &depth),
               ContractError);
  EXPECT_THROW(MeasuredOf(depth), ContractError);
}

TEST(ViewRanges, TheTrustedRangeIsThatOfWhatCountsInFusion) {
  DenseDepth depth = Completed(0.9);
  depth.range.colRange(0, kWidth / 4) = 7;
  EXPECT_EQ(TrustedRange(depth, 0.8), 3);  // By the network alone all are trusted.
  StateCompleted(1.0, &depth);
  depth.source.colRange(0, kWidth / 4) = static_cast<double>(RangeSource::kMeasured);
  EXPECT_EQ(TrustedRange(depth, 0.8), 7);   // Completed ones count less than stated.
  EXPECT_EQ(TrustedRange(depth, 0.95), 3);  // None is trusted.
}

TEST(ViewRanges, OneOfEachSquareIsSampledAndTakesThePlaceOfPoints) {
  SparseDepth sparse{cv::Mat::zeros(kHeight, kWidth, CV_32F),
                     cv::Mat::zeros(kHeight, kWidth, CV_32F)};
  sparse.range.at<float>(0, 1) = 9;
  sparse.confidence.at<float>(0, 1) = 0.6F;
  ASSERT_TRUE(SampleSquares(EverySecondColumn(0.05), 4, 0.5, {}, &sparse));
  EXPECT_EQ(cv::countNonZero(sparse.range), kWidth * kHeight / 16);
  EXPECT_EQ(sparse.range.at<float>(0, 1), 0);
  double most = 0;
  cv::minMaxLoc(sparse.range, nullptr, &most);
  EXPECT_EQ(most, 4);
  cv::minMaxLoc(sparse.confidence, nullptr, &most);
  EXPECT_NEAR(most, 0.8, 1e-6);  // 1 / (1 + (0.05 / 0.1)^2)
}

TEST(ViewRanges, TooFewSquaresAreNotSampled) {
  SparseDepth sparse{cv::Mat::zeros(kHeight, kWidth, CV_32F),
                     cv::Mat::zeros(kHeight, kWidth, CV_32F)};
  InverseRanges few = EverySecondColumn(0.05);
  few.value.colRange(4, kWidth) = 0;
  EXPECT_FALSE(SampleSquares(few, 4, 0.2, {}, &sparse));
  EXPECT_EQ(cv::countNonZero(sparse.range), 0);
}

}  // namespace
}  // namespace orb360
