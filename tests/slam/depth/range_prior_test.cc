#include "slam/depth/range_prior.h"

#include <cmath>

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(64, 32);

// A sphere around the camera, known with an expected error of a tenth.
DenseDepth Sphere(float range) {
  return {cv::Mat(32, 64, CV_32F, cv::Scalar(range)), cv::Mat(32, 64, CV_32F, cv::Scalar(1 / 1.1)),
          cv::Mat(32, 64, CV_8UC3, cv::Scalar::all(0))};
}

Features At(const std::vector<Eigen::Vector2d>& pixels) {
  Features features;
  for (const Eigen::Vector2d& pixel : pixels) {
    features.bearings.push_back(kCamera.Bearing(pixel));
    features.keypoints.push_back({pixel.cast<float>(), 0, 0.001F, 0, 50});
  }
  return features;
}

TEST(RangePriors, AreOfFeaturesWithoutALandmarkWhereTheDepthIsKnown) {
  const Features features = At({{10.5, 10.5}, {20.5, 20.5}, {63.9, 16.0}, {0.1, 31.9}});
  const std::vector<LandmarkId> landmarks = {kNoId, 7, kNoId, kNoId};
  const std::vector<RangePrior> priors = SampleRangePriors(Sphere(5), features, landmarks);
  ASSERT_EQ(priors.size(), 4u);
  for (const size_t f : {0, 2, 3}) {
    EXPECT_FLOAT_EQ(priors[f].range, 5.0F) << f;
    // A mean absolute error of 0.1, of Laplace's distribution.
    EXPECT_NEAR(priors[f].sigma, 0.1 * std::sqrt(2.0), 1e-6) << f;
  }
  EXPECT_EQ(priors[1].sigma, 0);
}

TEST(RangePriors, KnowNothingAtEdgesAndWhereTheNetworkDoesNot) {
  DenseDepth depth = Sphere(5);
  depth.range.at<float>(10, 63) = 8;              // an edge, across the seam as well
  depth.range.at<float>(20, 20) = 0;              // unknown
  depth.confidence.at<float>(25, 40) = 1 / 1.6F;  // an error of 60 %
  depth.confidence.at<float>(28, 40) = 0;         // none
  const Features features =
      At({{62.5, 10.5}, {0.5, 11.5}, {20.5, 20.5}, {40.5, 25.5}, {40.5, 28.5}, {30.5, 10.5}});
  const std::vector<LandmarkId> landmarks(6, kNoId);
  const std::vector<RangePrior> priors = SampleRangePriors(depth, features, landmarks);
  for (size_t f = 0; f < 5; ++f) EXPECT_EQ(priors[f].sigma, 0) << f;
  EXPECT_GT(priors[5].sigma, 0);
}

TEST(RangePriors, AreNeverMoreCertainThanAFewPerCent) {
  DenseDepth depth = Sphere(5);
  depth.confidence.setTo(1);
  EXPECT_NEAR(SampleRangePriors(depth, At({{1, 1}}), std::vector{kNoId}).front().sigma, 0.05, 1e-6);
}

TEST(RangePriors, ContractsAreChecked) {
  EXPECT_THROW(SampleRangePriors(Sphere(5), At({{1, 1}}), {}), ContractError);
}

}  // namespace
}  // namespace orb360
