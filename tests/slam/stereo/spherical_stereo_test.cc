#include "slam/stereo/spherical_stereo.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include "tests/slam/geometry/box_room.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(512, 256);

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
      MatchSphere(ViewFrom(kRoom, kReference), SourceAt({0.15, 0.2, 0.02}), {});
  Comparison comparison = CompareWithTruth(measured);
  EXPECT_GT(comparison.known, 0.6);
  EXPECT_LT(Median(comparison.errors), 0.03);
  EXPECT_LT(NearestRankQuantile(comparison.in_sigma, 0.68), 1.3);
}

TEST(MatchSphere, KnowsNothingAlongTheBaseline) {
  const Eigen::Vector3d offset(0.0, 0.25, 0.0);
  const InverseRanges measured = MatchSphere(ViewFrom(kRoom, kReference), SourceAt(offset), {});
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

TEST(MatchSphere, KnowsNothingThatTheSourceSeesAlongTheBaseline) {
  const Eigen::Vector3d offset(0.0, 0.9, 0.0);
  const InverseRanges measured = MatchSphere(ViewFrom(kRoom, kReference), SourceAt(offset), {});
  int num_known = 0;
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const float value = measured.value.at<float>(row, column);
      if (!(value > 0)) continue;
      ++num_known;
      const Eigen::Vector3d bearing =
          kReference.rotation * kCamera.Bearing({column + 0.5, row + 0.5});
      const Eigen::Vector3d from_source = bearing / value - offset;
      EXPECT_GT(from_source.normalized().cross(offset.normalized()).norm(), 0.09);
    }
  }
  EXPECT_GT(num_known, 10000);
}

TEST(MatchSphere, StatesNoErrorBelowTheLeastOne) {
  const StereoView reference = ViewFrom(kRoom, kReference);
  const StereoView source = SourceAt({0.15, 0.2, 0.02});
  SphericalStereoOptions options;
  options.triangulation.min_disparity_sigma = 0;
  const InverseRanges usual = MatchSphere(reference, source, options);
  options.triangulation.min_disparity_sigma = 5;
  const InverseRanges coarse = MatchSphere(reference, source, options);
  const cv::Mat is_known = usual.sigma > 0;
  ASSERT_GT(cv::countNonZero(is_known), 10000);
  EXPECT_EQ(cv::countNonZero(is_known & (coarse.sigma <= usual.sigma)), 0);
  EXPECT_GT(cv::mean(coarse.sigma, is_known)[0], 5 * cv::mean(usual.sigma, is_known)[0]);
}

TEST(MatchSphere, StatesLargerErrorsTowardsTheBaseline) {
  const Eigen::Vector3d offset(0.1, 0.3, 0.05);
  const InverseRanges measured = MatchSphere(ViewFrom(kRoom, kReference), SourceAt(offset), {});
  const Eigen::Vector3d axis = kReference.rotation.conjugate() * offset.normalized();
  std::vector<double> in_sigma;
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const float sigma = measured.sigma.at<float>(row, column);
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      if (!(sigma > 0) || axis.cross(bearing).norm() > 0.25) continue;
      const double truth = kRoom.Range(kReference.translation, kReference.rotation * bearing);
      in_sigma.push_back(std::abs(measured.value.at<float>(row, column) - 1 / truth) / sigma);
    }
  }
  ASSERT_GT(in_sigma.size(), 300u);
  // The same factor as at right angles to the baseline leaves 0.69 here.
  EXPECT_LT(NearestRankQuantile(in_sigma, 0.68), 0.55);
  EXPECT_GT(NearestRankQuantile(in_sigma, 0.68), 0.2);
}

const std::vector<Eigen::Vector3d> kOffsets = {{0.15, 0.2, 0.02}, {-0.2, 0.15, 0}, {0, 0, 0.25}};

TEST(MatchSphere, SeesMoreOfAFloorThatItExpectsWhereTheBaselineIsLong) {
  const StereoView reference = ViewFrom(kRoom, kReference);
  const StereoView source = SourceAt({2.5, 1.9, 0.1});
  const PlaneHypothesis floor{{0, 0, 1}, 1.5 + kReference.translation.z()};
  const auto known_floor = [&](const InverseRanges& measured) {
    int num_right = 0;
    for (int row = kCamera.height() / 2; row < kCamera.height(); ++row) {
      for (int column = 0; column < kCamera.width(); ++column) {
        const Eigen::Vector3d bearing =
            kReference.rotation * kCamera.Bearing({column + 0.5, row + 0.5});
        const double truth = kRoom.Range(kReference.translation, bearing);
        const bool is_floor = std::abs(truth * bearing.z() + floor.distance) < 1e-6;
        const double ratio = truth * measured.value.at<float>(row, column);
        num_right += is_floor && std::abs(ratio - 1) < 0.05;
      }
    }
    return num_right;
  };
  const int without = known_floor(MatchSphere(reference, source, {}));
  const int with = known_floor(MatchSphere(reference, source, {}, floor));
  EXPECT_GT(with, 1.5 * without);
  EXPECT_GT(with, 10000);
}

TEST(MatchSpheres, SourcesThatAgreeAreMoreExactThanOneForAnyNumberOfThreads) {
  const StereoView reference = ViewFrom(kRoom, kReference);
  std::vector<StereoView> sources;
  for (const Eigen::Vector3d& offset : kOffsets) sources.push_back(SourceAt(offset));
  const InverseRanges measured = MatchSpheres(reference, sources, {}, 2);
  Comparison one = CompareWithTruth(MatchSphere(reference, sources.front(), {}));
  Comparison fused = CompareWithTruth(measured);
  EXPECT_GT(fused.known, 0.6);
  EXPECT_LT(Median(fused.errors), 0.8 * Median(one.errors));
  EXPECT_LT(NearestRankQuantile(fused.errors, 0.95), 0.5 * NearestRankQuantile(one.errors, 0.95));
  const InverseRanges again = MatchSpheres(reference, sources, {}, 3);
  EXPECT_EQ(cv::norm(measured.value, again.value, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(measured.sigma, again.sigma, cv::NORM_INF), 0);
}

TEST(MatchSpheres, ChecksTheViews) {
  const StereoView reference = ViewFrom(kRoom, kReference);
  const std::vector<StereoView> same_place = {reference};
  EXPECT_THROW(MatchSpheres(reference, same_place, {}, 2), ContractError);
  StereoView small = SourceAt({0.1, 0, 0});
  small.gray = small.gray.rowRange(0, 100);
  EXPECT_THROW(MatchSpheres(reference, {&small, 1}, {}, 2), ContractError);
}

}  // namespace
}  // namespace orb360
