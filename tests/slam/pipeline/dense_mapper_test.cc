#include "slam/pipeline/dense_mapper.h"

#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/propagation_network.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

class DenseMapperTest : public testing::Test {
 protected:
  DenseMapperTest() {
    keyframe_.frame_index = 30;
    keyframe_.features = std::make_shared<Features>();
  }

  DenseMapper Make() const {
    return {WritePropagation(folder_), folder_ / "depth", {.height = 64, .min_points = 4}, 1};
  }
  cv::Mat Image() const { return {64, 128, CV_8UC3, cv::Scalar::all(90)}; }
  std::vector<SparsePoint> Points() const {
    std::vector<SparsePoint> points;
    for (int i = 0; i < 64; ++i) points.push_back({i, {2.0 * i + 0.5, 40.5}, 5.0, 1.0});
    return points;
  }

  TempFolder folder_;
  Keyframe keyframe_;
};

TEST_F(DenseMapperTest, KeepsTheDepthOfKeyframesAsLongAsItLives) {
  {
    DenseMapper mapper = Make();
    EXPECT_EQ(mapper.camera().width(), 128);
    mapper.Start(keyframe_, Image(), Points(), 0);
    EXPECT_EQ(mapper.pending(), 30);
    EXPECT_EQ(mapper.Take(1.0).frame_index, 30);
    mapper.Flush();
    EXPECT_EQ(mapper.failure(), nullptr);
    EXPECT_EQ(mapper.frames(), std::vector<int>{30});
    EXPECT_NEAR(mapper.depth_maps().Get(30).range.at<float>(40, 64), 5.0, 0.01);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "depth"));
}

TEST_F(DenseMapperTest, AKeyframeWithTooFewPointsGetsNoDepth) {
  DenseMapper mapper = Make();
  mapper.Start(keyframe_, Image(), {}, 0);
  EXPECT_FALSE(mapper.pending().has_value());
  EXPECT_TRUE(mapper.frames().empty());
}

TEST_F(DenseMapperTest, ADiskThatFailsIsNotedAndMappingGoesOn) {
  DenseMapper mapper = Make();
  std::filesystem::remove_all(folder_ / "depth");
  mapper.Start(keyframe_, Image(), Points(), 0);
  EXPECT_NO_THROW(mapper.Take(1.0));
  EXPECT_NO_THROW(mapper.Flush());
  ASSERT_NE(mapper.failure(), nullptr);
  EXPECT_THROW(std::rethrow_exception(mapper.failure()), UserError);
}

TEST_F(DenseMapperTest, KeepsImagesOfAMovingCameraOnly) {
  DenseMapper mapper = Make();
  const auto keep = [&](int frame_index, double place) {
    mapper.KeepImage(frame_index, Image(), {Eigen::Quaterniond::Identity(), {place, 0, 0}}, 5.0);
  };
  keep(0, 0.0);
  keep(1, 0.05);
  keep(2, 0.11);
  keep(3, 0.15);
  mapper.Flush();
  const auto is_kept = [&](const char* name) {
    return std::filesystem::exists(folder_ / "depth" / "images" / name);
  };
  EXPECT_TRUE(is_kept("0.jpg"));
  EXPECT_FALSE(is_kept("1.jpg"));
  EXPECT_TRUE(is_kept("2.jpg"));
  EXPECT_FALSE(is_kept("3.jpg"));
}

TEST_F(DenseMapperTest, ADiskThatTakesNoImageIsNotedAndTrackingGoesOn) {
  DenseMapper mapper = Make();
  std::filesystem::remove_all(folder_ / "depth" / "images");
  for (int i = 0; i < 3; ++i) {
    EXPECT_NO_THROW(mapper.KeepImage(
        i, Image(), {Eigen::Quaterniond::Identity(), Eigen::Vector3d(i, 0, 0)}, 5.0));
  }
  mapper.Flush();
  ASSERT_NE(mapper.failure(), nullptr);
  EXPECT_THROW(std::rethrow_exception(mapper.failure()), UserError);
  EXPECT_EQ(mapper.MeasureDepth({}, {}, nullptr), 0);
}

TEST_F(DenseMapperTest, TellsTheGroundFromTenAgreeingKeyframesOnly) {
  DenseMapper mapper = Make();
  const DenseGround seen{.up = {0, 0, 1}, .log_height = std::log(1.7), .sigma = 0.02};
  for (int i = 0; i < 9; ++i) mapper.AddGround(seen);
  EXPECT_FALSE(mapper.Ground().has_value());
  mapper.AddGround(seen);
  ASSERT_TRUE(mapper.Ground().has_value());
  EXPECT_NEAR(mapper.Ground()->camera_height, 1.7, 1e-9);
  EXPECT_TRUE(mapper.Ground()->is_rough);
  mapper.ForgetGrounds();
  for (int i = 0; i < 20; ++i) {
    mapper.AddGround({.up = {0, 0, 1}, .log_height = 0.5 * (i % 5), .sigma = 0.3});
  }
  EXPECT_FALSE(mapper.Ground().has_value());
}

}  // namespace
}  // namespace orb360
