#include "slam/depth/fusion_confidence.h"

#include <cstdint>

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

DenseDepth Stated(float error, RangeSource source) {
  const cv::Size size(4, 2);
  return {cv::Mat(size, CV_32F, cv::Scalar(3)), cv::Mat(size, CV_32F, cv::Scalar(1 / (1 + error))),
          cv::Mat(size, CV_8UC3, cv::Scalar::all(0)),
          cv::Mat(size, CV_8U, cv::Scalar(static_cast<double>(source)))};
}

float CountedError(float error, RangeSource source) {
  return 1 / FusionConfidence(Stated(error, source)).at<float>(1, 2) - 1;
}

TEST(FusionConfidence, MeasuredRangesAndThoseOfANetworkAloneCountAsStated) {
  for (const float error : {0.004F, 0.05F, 0.7F}) {
    EXPECT_NEAR(CountedError(error, RangeSource::kMeasured), error, 1e-6);
    EXPECT_NEAR(CountedError(error, RangeSource::kNetwork), error, 1e-6);
  }
  DenseDepth without = Stated(0.2F, RangeSource::kCompleted);
  without.source.release();
  EXPECT_EQ(FusionConfidence(without).at<float>(1, 2), without.confidence.at<float>(1, 2));
}

TEST(FusionConfidence, CompletedRangesCountLessThanAnyMeasuredOne) {
  EXPECT_NEAR(CountedError(0.001F, RangeSource::kCompleted), kLeastCompletedError, 1e-6);
  EXPECT_NEAR(CountedError(0.1F, RangeSource::kCompleted) / 0.1F,
              CountedError(0.2F, RangeSource::kCompleted) / 0.2F, 1e-5);
  EXPECT_GT(CountedError(0.1F, RangeSource::kCompleted), 0.3);
}

TEST(FusionConfidence, WhatIsAtABoundaryOrMovesIsUnknown) {
  for (const RangeSource source : {RangeSource::kBoundary, RangeSource::kMovingObject}) {
    EXPECT_NEAR(CountedError(0.1F, source), 1, 1e-6);
    EXPECT_NEAR(CountedError(3, source), 3, 1e-6);
  }
}

TEST(FusionConfidence, LeavesTheStatedOneAndWhatHasNone) {
  DenseDepth depth = Stated(0.1F, RangeSource::kBoundary);
  depth.confidence.at<float>(0, 0) = 0;
  EXPECT_EQ(FusionConfidence(depth).at<float>(0, 0), 0);
  EXPECT_NEAR(depth.confidence.at<float>(1, 2), 1 / 1.1, 1e-6);
  depth.source = depth.source.rowRange(0, 1);
  EXPECT_THROW(FusionConfidence(depth), ContractError);
}

}  // namespace
}  // namespace orb360
