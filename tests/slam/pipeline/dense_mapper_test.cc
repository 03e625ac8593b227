#include "slam/pipeline/dense_mapper.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "slam/pipeline/view_depth.h"
#include "tests/slam/pipeline/propagation_network.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

class DenseMapperTest : public testing::Test {
 protected:
  DenseMapper Make() const {
    return {WritePropagation(folder_), folder_ / "depth", {.height = 64, .min_points = 4}, 1};
  }

  TempFolder folder_;
};

TEST_F(DenseMapperTest, ItsFolderLivesAsLongAsItDoes) {
  {
    const DenseMapper mapper = Make();
    EXPECT_EQ(mapper.camera().width(), 128);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "depth"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "depth"));
}

TEST_F(DenseMapperTest, AfterAFailureThereIsNoDepth) {
  DenseMapper mapper = Make();
  std::filesystem::remove_all(folder_ / "depth" / "images");
  mapper.images().KeepKeyframe(0, cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90)));
  mapper.Flush();
  ASSERT_NE(mapper.failure(), nullptr);
  EXPECT_THROW(std::rethrow_exception(mapper.failure()), UserError);
  EXPECT_EQ(mapper.ComputeDepth({}, {}, {}).measured, 0);
}

TEST(ViewDepthOptions, HaveTheHeightOfTheCameraInTheUnitOfAResultWhoseScaleIsKnown) {
  MetricScale scale;
  scale.state = ScaleState::kRough;
  scale.value = 0.5;
  scale.camera_height = 1.7;
  EXPECT_DOUBLE_EQ(ViewDepthOptionsOf({}, scale).camera_height, 3.4);
  EXPECT_FALSE(ViewDepthOptionsOf({}, scale).baselines.empty());
  EXPECT_TRUE(ViewDepthOptionsOf({.stereo = false}, scale).baselines.empty());
  scale.state = ScaleState::kUnknown;
  EXPECT_EQ(ViewDepthOptionsOf({}, scale).camera_height, 0);
  EXPECT_EQ(ViewDepthOptionsOf({}, {}).camera_height, 0);
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
