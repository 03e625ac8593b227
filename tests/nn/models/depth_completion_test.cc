#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/graph/network_builder.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/models/depth_completion.h>

namespace orb360::nn {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

/// Confidence propagation over one level, in any unit: y = ln(depth / median) averaged.
NetworkBuilder Propagation(int size_multiple) {
  NetworkBuilder net(size_multiple);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("points", "median_log", {"depth", "confidence"}, nlohmann::json::object(), 3);
  net.NormalizedConvolution("mean", "points", "points.1", 1, 1, 15);
  net.weights[1].values = {0};
  net.Output("log_depth", "mean");
  net.Output("confidence", "mean.1");
  net.Output("scale", "points.2");
  return net;
}

struct Image {
  explicit Image(ImageSize size)
      : rgb(3 * static_cast<std::size_t>(size.height) * size.width, 128),
        depth(rgb.size() / 3),
        confidence(rgb.size() / 3) {}
  CompletionInput view() const { return {rgb, depth, confidence}; }
  std::vector<std::uint8_t> rgb;
  std::vector<float> depth;
  std::vector<float> confidence;
};

CompletionOutput Complete(const Graph& graph, ImageSize size, const Image& image) {
  const DepthCompletion model(graph, size);
  DepthCompletion::Workspace workspace(model);
  return model.Complete(image.view(), &workspace);
}

TEST(DepthCompletion, OnePointIsTheDepthAroundIt) {
  // A size that the network takes, one that it does not, and one below its smallest.
  for (const ImageSize size : {ImageSize{16, 32}, ImageSize{21, 39}, ImageSize{5, 9}}) {
    Image image(size);
    const std::size_t middle = image.depth.size() / 2;
    image.depth[middle] = 12.5f;
    image.confidence[middle] = 0.5f;
    const CompletionOutput dense = Complete(Propagation(8).Build(), size, image);
    ASSERT_EQ(dense.depth.size(), image.depth.size());
    ASSERT_EQ(dense.confidence.size(), image.depth.size());
    EXPECT_EQ(dense.scale, 12.5f);
    EXPECT_FALSE(dense.log_metric_scale);
    EXPECT_TRUE(dense.ground.empty());
    // Where nothing is seen the value is the bias: the median.
    EXPECT_THAT(dense.depth, Each(testing::FloatNear(12.5f, 1e-5f)));
    EXPECT_GT(dense.confidence[middle], 0);
  }
}

TEST(DepthCompletion, ScalesWithTheUnitOfThePoints) {
  const ImageSize size{16, 32};
  Image image(size);
  for (std::size_t i = 0; i < image.depth.size(); i += 7) {
    image.depth[i] = 1.0f + static_cast<float>(i % 50);
    image.confidence[i] = 0.25f + 0.01f * static_cast<float>(i % 60);
  }
  const Graph graph = Propagation(8).Build();
  const CompletionOutput metres = Complete(graph, size, image);
  for (float& depth : image.depth) depth *= 1024;  // exact, so that only logarithms round
  const CompletionOutput others = Complete(graph, size, image);
  for (std::size_t i = 0; i < metres.depth.size(); ++i) {
    ASSERT_NEAR(others.depth[i] / 1024, metres.depth[i], 1e-5 * metres.depth[i]);
    ASSERT_EQ(others.confidence[i], metres.confidence[i]);
  }
}

TEST(DepthCompletion, WhatIsNoPointDoesNotCount) {
  const ImageSize size{16, 32};
  Image good(size);
  good.depth[40] = 3;
  good.confidence[40] = 1;
  Image bad = good;
  bad.depth[100] = std::numeric_limits<float>::quiet_NaN();
  bad.depth[101] = std::numeric_limits<float>::infinity();
  bad.depth[102] = -1;
  bad.depth[103] = 5;
  for (const std::size_t i : {100, 101, 102}) bad.confidence[i] = 1;
  bad.confidence[103] = std::numeric_limits<float>::quiet_NaN();
  bad.confidence[40] = 7;  // more than certain
  // Without median_log, which would do the same.
  NetworkBuilder net(1);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.NormalizedConvolution("mean", "depth", "confidence", 1, 1, 5);
  net.Output("depth", "mean");
  net.Output("confidence", "mean.1");
  const Graph graph = net.Build();
  const CompletionOutput a = Complete(graph, size, good);
  const CompletionOutput b = Complete(graph, size, bad);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_THAT(a.depth, Each(testing::Ge(0)));
}

TEST(DepthCompletion, GivesTheImageAsRedGreenBlueBetween0And1) {
  const ImageSize size{2, 4};
  Image image(size);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    image.rgb[i] = static_cast<std::uint8_t>(51 * (i % 3));  // 0, 0.2, 0.4
  }
  NetworkBuilder net(1);
  net.Input("image", 3);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("green", "slice", {"image"}, {{"first", 1}, {"count", 1}});
  net.Node("blue", "slice", {"image"}, {{"first", 2}, {"count", 1}});
  net.Output("depth", "green");
  net.Output("confidence", "blue");
  const CompletionOutput dense = Complete(net.Build(), size, image);
  EXPECT_THAT(dense.depth, Each(testing::FloatEq(0.2f)));
  EXPECT_THAT(dense.confidence, Each(testing::FloatEq(0.4f)));
}

TEST(DepthCompletion, SeesImagesOfTheWidthThatTheNetworkExpects) {
  NetworkBuilder net = Propagation(8);
  net.json["normalisation"] = {{"width", 32}};
  const Graph graph = net.Build();
  for (const ImageSize size : {ImageSize{16, 32}, ImageSize{64, 128}, ImageSize{10, 20}}) {
    const DepthCompletion model(graph, size);
    EXPECT_EQ(model.network_size(), (ImageSize{16, 32}));
    DepthCompletion::Workspace workspace(model);
    Image image(size);
    image.depth[image.depth.size() / 2] = 7;
    image.confidence[image.depth.size() / 2] = 1;
    const CompletionOutput dense = model.Complete(image.view(), &workspace);
    EXPECT_THAT(dense.depth, testing::SizeIs(image.depth.size()));
    EXPECT_THAT(dense.depth, Each(testing::FloatNear(7, 1e-5f)));
  }
  for (const nlohmann::json& wrong :
       {nlohmann::json(0), nlohmann::json("512"), nlohmann::json(0.5), nlohmann::json(1 << 20)}) {
    net.json["normalisation"] = {{"width", wrong}};
    const Graph refused = net.Build();
    EXPECT_THAT(MessageOf<UserError>([&] {
                  DepthCompletion(refused, {16, 32});
                }),
                HasSubstr("should be an integer from 1 to 32768"));
  }
}

TEST(DepthCompletion, TakesAStatedErrorInThePlaceOfConfidenceThatMeansNone) {
  constexpr ImageSize kSize{8, 16};
  Image image(kSize);
  image.rgb.assign(image.rgb.size(), 51);                        // 0.2
  for (std::size_t i = 0; i < 3; ++i) image.rgb[3 * 5 + i] = 0;  // no depth there
  NetworkBuilder net = Propagation(8);
  net.Input("image", 3);
  net.Node("red", "slice", {"image"}, {{"first", 0}, {"count", 1}});
  net.Output("depth", "red");
  net.json["normalisation"] = {{"log_error", 0.25}};
  const CompletionOutput dense = Complete(net.Build(), kSize, image);
  for (std::size_t i = 0; i < dense.depth.size(); ++i) {
    EXPECT_FLOAT_EQ(dense.confidence[i], i == 5 ? 0.0F : 0.8F) << i;
  }
  for (const nlohmann::json& wrong :
       {nlohmann::json(0), nlohmann::json("0.2"), nlohmann::json(-1), nlohmann::json(11)}) {
    net.json["normalisation"] = {{"log_error", wrong}};
    const Graph refused = net.Build();
    EXPECT_THAT(MessageOf<UserError>([&] {
                  DepthCompletion(refused, {16, 32});
                }),
                HasSubstr("\"log_error\" of its normalisation should be a number above 0"));
  }
}

TEST(DepthCompletion, TellsTheGroundWhereTheNetworkDoes) {
  // A size that the network takes, and one that it does not.
  for (const ImageSize size : {ImageSize{8, 16}, ImageSize{21, 39}}) {
    Image image(size);
    for (std::size_t i = 2; i < image.rgb.size(); i += 3) image.rgb[i] = 204;  // blue: 0.8
    NetworkBuilder net = Propagation(8);
    net.Input("image", 3);
    net.Node("blue", "slice", {"image"}, {{"first", 2}, {"count", 1}});
    net.Output("ground", "blue");
    const CompletionOutput dense = Complete(net.Build(), size, image);
    ASSERT_EQ(dense.ground.size(), image.depth.size());
    EXPECT_THAT(dense.ground, Each(testing::FloatEq(0.8f)));
  }
}

TEST(DepthCompletion, RefusesNetworksForSomethingElse) {
  const auto refusal = [](const auto& change) {
    NetworkBuilder net = Propagation(1);
    change(&net);
    const Graph graph = net.Build();
    return MessageOf<UserError>([&] { DepthCompletion(graph, {8, 16}); });
  };
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->json["outputs"][0]["name"] = "z"; }),
              AllOf(HasSubstr("\"test\" is not for depth completion"), HasSubstr("\"depth\"")));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->json["outputs"][1]["name"] = "z"; }),
              HasSubstr("no output \"confidence\""));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->json["outputs"][2]["name"] = "z"; }),
              HasSubstr("no output \"scale\""));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->json["outputs"][0]["tensor"] = "points.2"; }),
              HasSubstr("output \"log_depth\" should have 1 channel of the image's size"));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->json["outputs"][2]["tensor"] = "mean"; }),
              HasSubstr("output \"scale\" should have 1 channel of 1x1"));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->Output("ground", "points.2"); }),
              HasSubstr("output \"ground\" should have 1 channel of the image's size"));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->Input("image", 4); }),
              HasSubstr("input \"image\" should have 3 channels"));
  EXPECT_THAT(refusal([](NetworkBuilder* net) { net->Input("normals", 3); }),
              HasSubstr("nothing is known of its input \"normals\""));
}

}  // namespace
}  // namespace orb360::nn
