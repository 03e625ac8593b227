#include "slam/evaluation/depth_calibration.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "slam/evaluation/depth_error.h"

namespace orb360 {
namespace {

const cv::Size kSize(256, 128);

cv::Mat Constant(double value) { return {kSize, CV_32FC1, cv::Scalar(value)}; }

float ConfidenceOf(double error) { return static_cast<float>(1 / (1 + error)); }

TEST(DepthCalibration, ErrorsThatAreAsLargeAsStatedAreSoInEveryTenth) {
  // The expected error grows from pixel to pixel; the errors have its exponential distribution.
  std::mt19937 random(3);
  std::exponential_distribution<double> exponential(1.0);
  const cv::Mat truth = Constant(10);
  cv::Mat estimate = truth.clone();
  cv::Mat confidence = truth.clone();
  for (int row = 0; row < kSize.height; ++row) {
    for (int column = 0; column < kSize.width; ++column) {
      const double stated = 0.01 + 0.4 * std::uniform_real_distribution<double>()(random);
      confidence.at<float>(row, column) = ConfidenceOf(stated);
      estimate.at<float>(row, column) = static_cast<float>(10 * (1 + stated * exponential(random)));
    }
  }
  const DepthCalibration calibration = CompareConfidence(truth, estimate, confidence);
  double last = 0;
  for (const DepthCalibration::Means& tenth : calibration.Tenths()) {
    EXPECT_NEAR(tenth.observed / tenth.stated, 1, 0.1);
    EXPECT_GT(tenth.stated, last);
    last = tenth.stated;
  }
  EXPECT_LT(calibration.Risk(0.5), 0.6 * calibration.Risk(1.0));
  EXPECT_NEAR(calibration.Risk(1.0), CompareDepth(truth, estimate).total.AbsRel(), 1e-6);
}

TEST(DepthCalibration, TenthsAreOfTheSphereAndNotOfPixels) {
  // Above 30 degrees, a quarter of the sphere and a third of the rows, the error is 30 %, else 10
  // %.
  cv::Mat estimate = Constant(11);
  cv::Mat confidence = Constant(ConfidenceOf(0.1));
  const int rows = kSize.height / 3;
  estimate.rowRange(0, rows) = 13;
  confidence.rowRange(0, rows) = ConfidenceOf(0.3);
  const auto tenths = CompareConfidence(Constant(10), estimate, confidence).Tenths();
  for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(tenths[i].observed, 0.1, 1e-4) << i;
  EXPECT_NEAR(tenths[7].observed, 0.2, 0.02);
  EXPECT_NEAR(tenths[7].stated, 0.2, 0.02);
  for (size_t i = 8; i < 10; ++i) EXPECT_NEAR(tenths[i].observed, 0.3, 1e-4) << i;
}

TEST(DepthCalibration, LeavesOutTheSkyAndWhatIsUnknownOrFar) {
  cv::Mat truth = Constant(10);
  cv::Mat estimate = Constant(11);
  cv::Mat confidence = Constant(0.9);
  truth.rowRange(0, 20) = 0;
  truth.rowRange(20, 30) = 90;
  estimate.rowRange(30, 40) = 0;
  confidence.rowRange(40, 50) = 0;
  estimate.rowRange(0, 30) = 50;
  estimate.rowRange(40, 50) = 50;
  EXPECT_NEAR(CompareConfidence(truth, estimate, confidence).Risk(1.0), 0.1, 1e-6);
}

TEST(DepthCalibration, SumsOfImagesAreThoseOfTheirPixels) {
  DepthCalibration sum = CompareConfidence(Constant(10), Constant(11), Constant(0.9));
  sum += CompareConfidence(Constant(10), Constant(15), Constant(0.5));
  EXPECT_NEAR(sum.Risk(0.5), 0.1, 1e-6);
  EXPECT_NEAR(sum.Risk(1.0), 0.3, 1e-6);
}

TEST(DepthCalibration, IsNotANumberWithoutPixels) {
  EXPECT_TRUE(std::isnan(DepthCalibration().Tenths()[0].observed));
  EXPECT_TRUE(std::isnan(DepthCalibration().Risk(0.5)));
}

TEST(PixelSolidAngle, OfAllPixelsIsTheSphere) {
  double sum = 0;
  for (int row = 0; row < kSize.height; ++row) sum += kSize.width * PixelSolidAngle(row, kSize);
  EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-9);
}

}  // namespace
}  // namespace orb360
