#include "slam/stereo/inverse_ranges.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// The same in each of 11 pixels, which no vector holds.
InverseRanges Uniform(float value, float sigma) {
  return {cv::Mat(1, 11, CV_32F, cv::Scalar(value)), cv::Mat(1, 11, CV_32F, cv::Scalar(sigma))};
}

TEST(FuseInverseRanges, TakesTheMeanOfTheLargestSetThatAgreesByVarianceOnEveryInstructionSet) {
  const std::vector<InverseRanges> measured = {Uniform(0.5f, 0.01f), Uniform(0.9f, 0.001f),
                                               Uniform(0.52f, 0.02f), Uniform(0.0f, 0.0f)};
  ForEachDispatchTarget([&] {
    const InverseRanges fused = FuseInverseRanges(measured, {}, 2);
    for (int x = 0; x < 11; ++x) {
      EXPECT_NEAR(fused.value.at<float>(x), (0.5 * 4 + 0.52) / 5, 1e-6);
      EXPECT_NEAR(fused.sigma.at<float>(x), 0.01 / std::sqrt(1.25), 1e-6);
    }
  });
}

TEST(FuseInverseRanges, KnowsNothingWhereSourcesContradictEachOtherOrAllAreUncertain) {
  const std::vector<InverseRanges> contradicting = {Uniform(0.5f, 0.01f), Uniform(0.9f, 0.01f)};
  EXPECT_EQ(cv::countNonZero(FuseInverseRanges(contradicting, {}).sigma), 0);
  const std::vector<InverseRanges> far = {Uniform(0.01f, 0.01f), Uniform(0.011f, 0.01f)};
  EXPECT_EQ(cv::countNonZero(FuseInverseRanges(far, {}).sigma), 0);
  const std::vector<InverseRanges> none = {Uniform(0, 0), Uniform(0, 0)};
  EXPECT_EQ(cv::countNonZero(FuseInverseRanges(none, {}).value), 0);
}

TEST(FuseInverseRanges, ChecksTheNumberOfMeasurements) {
  EXPECT_THROW(FuseInverseRanges({}, {}), ContractError);
  const std::vector<InverseRanges> many(kMaxStereoSources + 1, Uniform(0.5f, 0.01f));
  EXPECT_THROW(FuseInverseRanges(many, {}), ContractError);
}

}  // namespace
}  // namespace orb360
