#include "slam/evaluation/depth_error.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

constexpr double kPi = std::numbers::pi;
const cv::Size kSize(48, 24);

cv::Mat Constant(float range) { return {kSize, CV_32FC1, cv::Scalar(range)}; }

TEST(DepthError, TheTruthHasNoErrorAndCoversTheSphere) {
  const DepthErrors errors = CompareDepth(Constant(7.0f), Constant(7.0f));
  EXPECT_NEAR(errors.total.weight, 4.0 * kPi, 1e-9);
  EXPECT_EQ(errors.total.Rmse(), 0.0);
  EXPECT_EQ(errors.total.Mae(), 0.0);
  EXPECT_EQ(errors.total.AbsRel(), 0.0);
  EXPECT_EQ(errors.total.Delta125(), 1.0);
  EXPECT_EQ(errors.total.Coverage(), 1.0);
}

TEST(DepthError, AConstantOffsetIsTheErrorEverywhere) {
  const DepthErrors errors = CompareDepth(Constant(8.0f), Constant(10.5f));
  for (const DepthErrorBin& bin : {errors.total, errors.by_range[1], errors.by_latitude[0],
                                   errors.by_latitude[3], errors.by_latitude[5]}) {
    EXPECT_NEAR(bin.Rmse(), 2.5, 1e-9);
    EXPECT_NEAR(bin.Mae(), 2.5, 1e-9);
    EXPECT_NEAR(bin.AbsRel(), 2.5 / 8.0, 1e-9);
    EXPECT_EQ(bin.Delta125(), 0.0);
  }
}

TEST(DepthError, DeltaCountsBothTooFarAndTooNear) {
  EXPECT_EQ(CompareDepth(Constant(10.0f), Constant(12.4f)).total.Delta125(), 1.0);
  EXPECT_EQ(CompareDepth(Constant(10.0f), Constant(12.6f)).total.Delta125(), 0.0);
  EXPECT_EQ(CompareDepth(Constant(10.0f), Constant(8.1f)).total.Delta125(), 1.0);
  EXPECT_EQ(CompareDepth(Constant(10.0f), Constant(7.9f)).total.Delta125(), 0.0);
}

TEST(DepthError, ACapCountsByItsSolidAngle) {
  // The rows above 30 degrees cover a quarter of the sphere, though a third of the image.
  cv::Mat estimate = Constant(10.0f);
  estimate.rowRange(0, kSize.height / 3).setTo(14.0f);
  const DepthErrors errors = CompareDepth(Constant(10.0f), estimate);
  EXPECT_NEAR(errors.total.Mae(), 4.0 * 0.25, 1e-9);
  EXPECT_NEAR(errors.total.Rmse(), 4.0 * std::sqrt(0.25), 1e-9);
  EXPECT_NEAR(errors.by_latitude[5].Mae(), 4.0, 1e-9);
  EXPECT_NEAR(errors.by_latitude[4].Mae(), 4.0, 1e-9);
  EXPECT_NEAR(errors.by_latitude[3].Mae(), 0.0, 1e-9);
  EXPECT_NEAR(errors.by_latitude[5].weight, 2.0 * kPi * (1.0 - std::sin(kPi / 3)), 1e-9);
}

TEST(DepthError, PixelsWithoutTruthDoNotCountAndThoseWithoutEstimateLowerTheCoverage) {
  cv::Mat truth = Constant(10.0f);
  cv::Mat estimate = Constant(11.0f);
  truth.colRange(0, kSize.width / 4).setTo(0.0f);
  estimate.colRange(kSize.width / 2, kSize.width).setTo(0.0f);
  const DepthErrors errors = CompareDepth(truth, estimate);
  EXPECT_NEAR(errors.total.truth_weight, 3.0 * kPi, 1e-9);
  EXPECT_NEAR(errors.total.Coverage(), 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(errors.total.Mae(), 1.0, 1e-9);
}

TEST(DepthError, RangesFallIntoTheirBinsAndEndAtEightyMetres) {
  cv::Mat truth = Constant(0.0f);
  const float ranges[] = {5.0f, 5.1f, 15.0f, 39.0f, 80.0f, 80.1f};
  for (int i = 0; i < 6; ++i) truth.colRange(8 * i, 8 * (i + 1)).setTo(ranges[i]);
  const DepthErrors errors = CompareDepth(truth, Constant(20.0f));
  const double expected[] = {15.0, 14.9, 5.0, 19.0, 60.0};
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(errors.by_range[i].Mae(), expected[i], 1e-5) << i;
  EXPECT_NEAR(errors.total.truth_weight, 4.0 * kPi * 5.0 / 6.0, 1e-9);
}

TEST(DepthError, ImagesAddUp) {
  DepthErrors sum = CompareDepth(Constant(10.0f), Constant(11.0f));
  sum += CompareDepth(Constant(10.0f), Constant(13.0f));
  EXPECT_NEAR(sum.total.Mae(), 2.0, 1e-9);
  EXPECT_NEAR(sum.total.Rmse(), std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(sum.by_range[1].Mae(), 2.0, 1e-9);
  EXPECT_TRUE(std::isnan(sum.by_range[4].Mae()));
}

}  // namespace
}  // namespace orb360
