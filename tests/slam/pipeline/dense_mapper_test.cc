#include "slam/pipeline/dense_mapper.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/propagation_network.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

class DenseMapperTest : public testing::Test {
 protected:
  DenseMapper Make() const {
    return {WritePropagation(folder_), folder_ / "depth", {.height = 64, .min_points = 4}, 1};
  }
  cv::Mat Image() const { return {64, 128, CV_8UC3, cv::Scalar::all(90)}; }
  bool IsKept(const std::string& name) const {
    return std::filesystem::exists(folder_ / "depth" / "images" / name);
  }

  TempFolder folder_;
};

TEST_F(DenseMapperTest, KeepsImagesOfAMovingCameraAsLongAsItLives) {
  {
    DenseMapper mapper = Make();
    const auto keep = [&](int frame_index, double place) {
      mapper.KeepImage(frame_index, Image(), {Eigen::Quaterniond::Identity(), {place, 0, 0}}, 5.0);
    };
    keep(0, 0.0);
    keep(1, 0.05);
    keep(2, 0.11);
    keep(3, 0.15);
    mapper.Flush();
    EXPECT_TRUE(IsKept("0.jpg"));
    EXPECT_FALSE(IsKept("1.jpg"));
    EXPECT_TRUE(IsKept("2.jpg"));
    EXPECT_FALSE(IsKept("3.jpg"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "depth"));
}

TEST_F(DenseMapperTest, KeepsEveryKeyframeWhetherOrNotTheCameraMoves) {
  DenseMapper mapper = Make();
  mapper.KeepImage(0, Image(), Rigid3(), 5.0);
  mapper.KeepKeyframe(0, Image());
  mapper.KeepImage(1, Image(), Rigid3(), 5.0);
  mapper.KeepKeyframe(1, Image());
  mapper.Flush();
  EXPECT_TRUE(IsKept("0.jpg"));
  EXPECT_TRUE(IsKept("1.jpg"));
}

TEST_F(DenseMapperTest, KeepsTheNewestFramesWithoutAPose) {
  DenseMapper mapper = Make();
  for (int i = 0; i < 103; ++i) mapper.KeepUnplaced(i, Image());
  mapper.KeepImage(103, Image(), Rigid3(), 5.0);  // The first of a map is always kept.
  for (int i = 104; i < 110; ++i) mapper.KeepUnplaced(i, Image());
  mapper.Flush();
  EXPECT_TRUE(IsKept("0.jpg"));  // Perhaps the reference of the first map.
  EXPECT_FALSE(IsKept("1.jpg"));
  EXPECT_FALSE(IsKept("2.jpg"));
  EXPECT_TRUE(IsKept("3.jpg"));
  EXPECT_TRUE(IsKept("103.jpg"));
  EXPECT_TRUE(IsKept("109.jpg"));
}

TEST_F(DenseMapperTest, TheFirstFrameOfTheNextMapIsKeptThoughTheCameraHasNotMoved) {
  DenseMapper mapper = Make();
  mapper.KeepImage(0, Image(), Rigid3(), 5.0);
  mapper.KeepUnplaced(1, Image());
  mapper.KeepImage(2, Image(), Rigid3(), 5.0);
  mapper.KeepImage(3, Image(), Rigid3(), 5.0);
  mapper.Flush();
  EXPECT_TRUE(IsKept("2.jpg"));
  EXPECT_FALSE(IsKept("3.jpg"));
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
  EXPECT_EQ(mapper.ComputeDepth({}, {}, nullptr).measured, 0);
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
