#include "slam/depth/exposure.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

class EstimateGainsTest : public testing::Test {
 protected:
  EstimateGainsTest() {
    for (size_t i = 0; i < 6; ++i) {
      DenseView view{.frame_index = static_cast<int>(i),
                     .world_from_camera = TurnedCamera({-0.6 + 0.2 * static_cast<double>(i), 0, 0},
                                                       0.1 * static_cast<double>(i)),
                     .neighbours = {}};
      for (size_t j = 0; j < 6; ++j) {
        if (j != i) view.neighbours.push_back(j);
      }
      views_.push_back(view);
      depths_.push_back(RangeRoom().Render({256, 128}, view.world_from_camera));
    }
  }

  std::vector<Eigen::Array3f> Estimate(const ExposureOptions& options = {}) const {
    return EstimateGains(
        views_, [this](int frame) { return depths_[static_cast<size_t>(frame)]; }, options);
  }

  std::vector<DenseView> views_;
  std::vector<DenseDepth> depths_;
};

TEST_F(EstimateGainsTest, AreOneWhereTheExposureIsConstant) {
  for (const Eigen::Array3f& gain : Estimate()) EXPECT_LT((gain - 1).abs().maxCoeff(), 1e-4F);
}

TEST_F(EstimateGainsTest, UndoTheExposureAndTheWhiteBalanceOfEachView) {
  std::vector<Eigen::Array3d> applied;
  Eigen::Array3d mean_logarithm = Eigen::Array3d::Zero();
  for (size_t i = 0; i < views_.size(); ++i) {
    const double angle = 1.3 * static_cast<double>(i);
    const Eigen::Array3d factor(0.9 + 0.25 * std::sin(angle), 0.9 + 0.2 * std::sin(angle),
                                0.9 + 0.25 * std::sin(angle + 0.5));
    cv::multiply(depths_[i].color, cv::Scalar(factor[0], factor[1], factor[2]), depths_[i].color);
    applied.push_back(factor);
    mean_logarithm += factor.log() / static_cast<double>(views_.size());
  }
  const std::vector<Eigen::Array3f> gains = Estimate();
  for (size_t i = 0; i < views_.size(); ++i) {
    // Nobody knows the exposure of all views together.
    const Eigen::Array3d product = gains[i].cast<double>() * applied[i] / mean_logarithm.exp();
    EXPECT_LT((product - 1).abs().maxCoeff(), 0.02) << i;
  }
}

TEST_F(EstimateGainsTest, ColoursOfOtherSurfacesAreNotCompared) {
  // The second half of the views claims to be elsewhere, where it sees the same walls farther away.
  for (size_t i = 3; i < 6; ++i) {
    depths_[i].range *= 1.5;
    depths_[i].color *= 0.5;
  }
  for (const Eigen::Array3f& gain : Estimate()) EXPECT_LT((gain - 1).abs().maxCoeff(), 0.02F);
}

TEST_F(EstimateGainsTest, WhatMovesIsNotCompared) {
  for (DenseDepth& depth : depths_) {
    depth.source = cv::Mat(depth.range.size(), CV_8U,
                           cv::Scalar(static_cast<double>(RangeSource::kMovingObject)));
  }
  depths_[2].color *= 0.5;
  for (const Eigen::Array3f& gain : Estimate()) EXPECT_EQ(gain.matrix(), Eigen::Vector3f::Ones());
}

TEST_F(EstimateGainsTest, ViewsThatSeeNothingOfEachOtherKeepTheirColours) {
  for (DenseView& view : views_) view.neighbours.clear();
  depths_[2].color *= 0.5;
  for (const Eigen::Array3f& gain : Estimate()) EXPECT_EQ(gain.matrix(), Eigen::Vector3f::Ones());
  views_.clear();
  EXPECT_TRUE(Estimate().empty());
}

}  // namespace
}  // namespace orb360
