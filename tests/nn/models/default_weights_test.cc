#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <orb360/nn/graph/network_file.h>
#include <orb360/nn/models/default_weights.h>
#include <orb360/nn/models/depth_completion.h>

namespace orb360::nn {
namespace {

TEST(DefaultWeights, AreThoseOfTheSourcesInABuild) {
  EXPECT_EQ(DefaultWeights(),
            std::filesystem::path(ORB360_SOURCE_DIR) / "weights/depth_completion.h5");
}

TEST(DefaultWeights, TellDepthConfidenceGroundAndScale) {
  const ImageSize size{64, 128};
  const DepthCompletion model(ReadNetwork(DefaultWeights()), size);
  DepthCompletion::Workspace workspace(model);
  const std::size_t pixels = 64 * 128;
  const std::vector<std::uint8_t> rgb(3 * pixels, 128);
  std::vector<float> depth(pixels);
  std::vector<float> confidence(pixels);
  for (std::size_t i = 0; i < pixels; i += 50) {
    depth[i] = 4;
    confidence[i] = 0.9f;
  }
  const CompletionOutput dense = model.Complete({rgb, depth, confidence}, &workspace);
  EXPECT_EQ(dense.scale, 4);
  EXPECT_TRUE(dense.log_metric_scale.has_value());
  EXPECT_THAT(dense.depth, testing::Each(testing::Gt(0)));
  for (const std::vector<float>* fraction : {&dense.confidence, &dense.ground}) {
    ASSERT_EQ(fraction->size(), pixels);
    EXPECT_THAT(*fraction, testing::Each(testing::AllOf(testing::Ge(0), testing::Le(1))));
  }
}

}  // namespace
}  // namespace orb360::nn
