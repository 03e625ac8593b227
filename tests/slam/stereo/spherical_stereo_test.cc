#include "slam/stereo/spherical_stereo.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include "tests/slam/geometry/box_room.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(512, 256);

SphericalStereoOptions SmallOptions() {
  SphericalStereoOptions options;
  options.matching.num_levels = 3;
  return options;
}

StereoView ViewFrom(const BoxRoom& room, const Rigid3& pose) {
  cv::Mat gray;
  cv::cvtColor(room.Render(kCamera, pose), gray, cv::COLOR_BGR2GRAY);
  return {gray, pose};
}

const BoxRoom kRoom({4.0, 3.0, 1.5}, 3);
// World units need not be metres, and the camera is tilted.
const Rigid3 kReference{ExpSo3({0.2, -0.1, 0.7}), {0.3, -0.2, 0.1}};

StereoView SourceAt(const Eigen::Vector3d& offset) {
  return ViewFrom(kRoom, {ExpSo3({-0.1, 0.05, 1.5}), kReference.translation + offset});
}

// Fraction of the sphere with a range, and |error| of the inverse range in standard deviations.
struct Comparison {
  double known = 0;
  std::vector<double> errors;  // of ln(range)
  std::vector<double> in_sigma;
};

Comparison CompareWithTruth(const InverseRanges& measured) {
  Comparison result;
  double solid_angle = 0;
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      const double weight = std::hypot(bearing.x(), bearing.y());
      solid_angle += weight;
      const float sigma = measured.sigma.at<float>(row, column);
      if (!(sigma > 0)) continue;
      result.known += weight;
      const double truth = kRoom.Range(kReference.translation, kReference.rotation * bearing);
      const double error = measured.value.at<float>(row, column) - 1 / truth;
      result.errors.push_back(std::abs(error) * truth);
      result.in_sigma.push_back(std::abs(error) / sigma);
    }
  }
  result.known /= solid_angle;
  return result;
}

TEST(MatchSphere, MeasuresTheRangeOfWallsAllAround) {
  const InverseRanges measured =
      MatchSphere(ViewFrom(kRoom, kReference), SourceAt({0.15, 0.2, 0.02}), SmallOptions(), 2);
  Comparison comparison = CompareWithTruth(measured);
  EXPECT_GT(comparison.known, 0.6);
  EXPECT_LT(Median(comparison.errors), 0.03);
  EXPECT_LT(NearestRankQuantile(comparison.in_sigma, 0.68), 1.3);
}

TEST(MatchSphere, KnowsNothingAlongTheBaseline) {
  const Eigen::Vector3d offset(0.0, 0.25, 0.0);
  const InverseRanges measured =
      MatchSphere(ViewFrom(kRoom, kReference), SourceAt(offset), SmallOptions(), 2);
  const Eigen::Vector3d axis = kReference.rotation.conjugate() * offset.normalized();
  int num_near = 0;
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      if (axis.cross(bearing).norm() > std::sin(0.095)) continue;
      ++num_near;
      EXPECT_EQ(measured.sigma.at<float>(row, column), 0) << column << ", " << row;
    }
  }
  EXPECT_GT(num_near, 50);
}

TEST(FuseInverseRanges, TwoSourcesThatAgreeAreMoreExactThanOne) {
  const StereoView reference = ViewFrom(kRoom, kReference);
  std::vector<InverseRanges> measured;
  for (const Eigen::Vector3d& offset :
       {Eigen::Vector3d(0.15, 0.2, 0.02), Eigen::Vector3d(-0.2, 0.15, 0),
        Eigen::Vector3d(0, 0, 0.25)}) {
    measured.push_back(MatchSphere(reference, SourceAt(offset), SmallOptions(), 2));
  }
  Comparison one = CompareWithTruth(measured.front());
  Comparison fused = CompareWithTruth(FuseInverseRanges(measured, SmallOptions()));
  EXPECT_GT(fused.known, 0.6);
  EXPECT_LT(Median(fused.errors), 0.8 * Median(one.errors));
  EXPECT_LT(NearestRankQuantile(fused.errors, 0.95), 0.5 * NearestRankQuantile(one.errors, 0.95));
}

InverseRanges Single(float value, float sigma) {
  return {cv::Mat(1, 1, CV_32F, cv::Scalar(value)), cv::Mat(1, 1, CV_32F, cv::Scalar(sigma))};
}

TEST(FuseInverseRanges, TakesTheMeanOfTheLargestSetThatAgreesByVariance) {
  const std::vector<InverseRanges> measured = {Single(0.5f, 0.01f), Single(0.9f, 0.001f),
                                               Single(0.52f, 0.02f), Single(0.0f, 0.0f)};
  const InverseRanges fused = FuseInverseRanges(measured, {});
  EXPECT_NEAR(fused.value.at<float>(0), (0.5 * 4 + 0.52) / 5, 1e-6);
  EXPECT_NEAR(fused.sigma.at<float>(0), 0.01 / std::sqrt(1.25), 1e-6);
}

TEST(FuseInverseRanges, KnowsNothingWhereSourcesContradictEachOtherOrAllAreUncertain) {
  const std::vector<InverseRanges> contradicting = {Single(0.5f, 0.01f), Single(0.9f, 0.01f)};
  EXPECT_EQ(FuseInverseRanges(contradicting, {}).sigma.at<float>(0), 0);
  const std::vector<InverseRanges> far = {Single(0.01f, 0.01f), Single(0.011f, 0.01f)};
  EXPECT_EQ(FuseInverseRanges(far, {}).sigma.at<float>(0), 0);
}

}  // namespace
}  // namespace orb360
