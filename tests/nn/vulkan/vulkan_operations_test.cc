// Every operation on a Vulkan device, against PyTorch's results and against double precision.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/nn/graph/network_builder.h"
#include "tests/nn/graph/network_run.h"
#include "tests/nn/graph/node_check.h"
#include "tests/nn/graph/random_network.h"
#include "tests/nn/graph/reference_check.h"
#include "tests/nn/kernels/plain_image.h"
#include "tests/nn/vulkan/vulkan_fixture.h"

namespace orb360::nn {
namespace {

class VulkanOperationReference : public VulkanTest,
                                 public ::testing::WithParamInterface<const char*> {};

TEST_P(VulkanOperationReference, IsWhatPyTorchComputes) {
  ExpectEveryTensorOf(ReferenceFile(GetParam()), kRoundingsOfOperation, options());
}

TEST_P(VulkanOperationReference, IsTheSameInANetworkMadeForSpeed) {
  ExpectOutputsOf(ReferenceFile(GetParam()), kRoundingsOfOperation, options());
}

INSTANTIATE_TEST_SUITE_P(Every, VulkanOperationReference, ::testing::ValuesIn(kReferenceOperations),
                         [](const auto& suite) { return std::string(suite.param); });

using VulkanOperations = VulkanTest;

// Sizes of one pixel, below and above a workgroup, and not a multiple of it.
constexpr std::pair<int, int> kSizes[] = {{1, 1}, {1, 7}, {5, 1}, {7, 9}, {33, 35}, {6, 150}};

TEST_F(VulkanOperations, AreRightForImagesOfAnySize) {
  NetworkBuilder net(1);
  net.Input("x", 3);
  net.Convolution("wide", "x", 3, 70, 3, 2);
  net.Convolution("a", "wide", 70, 17, 5, 2, "zero");
  net.Convolution("b", "a", 17, 18, 1);
  net.Node("leaky", "leaky_relu", {"b"}, {{"slope", 0.1}});
  net.NormalizedConvolution("d", "x", "x", 3, 2, 5);
  net.NormalizedConvolution("largest", "x", "x", 3, 5, 15, "zero");
  net.Node("mean", "global_average_pool", {"leaky"});
  net.Dense("g", "mean", 18, 70);
  net.Node("row", "latitude_sine", {"x"});
  for (const char* name : {"leaky", "d", "largest", "g", "row"}) net.Output(name, name);
  const Graph graph = net.Build();
  for (const auto& [height, width] : kSizes) {
    SCOPED_TRACE(testing::Message() << width << "x" << height);
    ExpectEveryNodeRight(graph, {RandomImage({3, height, width}, 0.1f, 1, 1)}, options());
  }
}

TEST_F(VulkanOperations, ChangeTheSizeOfImagesOfAnySize) {
  NetworkBuilder net(2);
  net.Input("x", 5);
  net.Input("c", 5);
  net.Node("average", "average_pool", {"x"});
  net.Node("quarter", "confidence_pool", {"x", "c"}, {{"rule", "quarter"}}, 2);
  net.Node("root", "confidence_pool", {"x", "c"}, {{"rule", "sqrt"}}, 2);
  net.Node("nearest", "upsample_nearest", {"average"});
  net.Node("zero", "upsample_bilinear", {"average"}, {{"padding", "zero"}});
  net.Node("wrap", "upsample_bilinear", {"average"}, {{"padding", "wrap_replicate"}});
  net.Node("pole", "upsample_bilinear", {"x"}, {{"padding", "wrap_cross_pole"}});
  net.Node("one", "slice", {"average"}, {{"first", 3}, {"count", 1}});
  net.Convolution("weights", "average", 5, 36, 1);
  net.Node("convex", "convex_upsample", {"one", "weights"}, {{"padding", "wrap_replicate"}});
  net.Convolution("nine", "average", 5, 9, 1);
  net.Node("filter", "convex_upsample", {"one", "nine"}, {{"padding", "zero"}, {"factor", 1}});
  for (const char* name : {"quarter", "quarter.1", "root", "root.1", "nearest", "zero", "wrap",
                           "pole", "convex", "filter"}) {
    net.Output(name, name);
  }
  const Graph graph = net.Build();
  for (const auto& [height, width] : kSizes) {
    SCOPED_TRACE(testing::Message() << 2 * width << "x" << 2 * height);
    ExpectEveryNodeRight(graph,
                         {RandomImage({5, 2 * height, 2 * width}, -1, 1, 1),
                          // Where all of a square are negative, the root is NaN.
                          RandomImage({5, 2 * height, 2 * width}, -1, 1, 2)},
                         options());
  }
}

TEST_F(VulkanOperations, GiveTheMeanOfALargeImage) {
  NetworkBuilder net(1);
  net.Input("x", 6);
  net.Output(net.Node("mean", "global_average_pool", {"x"}), "mean");
  constexpr std::size_t kPixels = 512 * 1024;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PlainImage x({6, 512, 1024});
  const double constants[] = {0.1f, -3.3f, 1, 1, 1, 1};
  for (std::size_t i = 0; i < x.values.size(); ++i) x.values[i] = constants[i / kPixels];
  x.values[3 * kPixels + 1000] = kInfinity;
  x.values[4 * kPixels + 1000] = std::numeric_limits<double>::quiet_NaN();
  x.values[5 * kPixels + 1000] = kInfinity;
  x.values[5 * kPixels + 3000] = -kInfinity;
  const auto mean = RunOnce(Executor(net.Build(), 512, 1024, options()), {x})[0];
  for (std::size_t c = 0; c < 3; ++c) {
    // Half a unit of 2^-24 for each of some operations, as if there were few pixels.
    EXPECT_NEAR(mean[c] / constants[c], 1, 10 * 0x1p-24) << c;
  }
  EXPECT_EQ(mean[3], kInfinity);
  EXPECT_TRUE(std::isnan(mean[4]) && std::isnan(mean[5])) << mean[4] << ' ' << mean[5];
}

TEST_F(VulkanOperations, FindTheMedianOfAnyNumberOfPoints) {
  NetworkBuilder net(1);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("points", "median_log", {"depth", "confidence"}, nlohmann::json::object(), 3);
  net.Output("x", "points");
  net.Output("c", "points.1");
  net.Output("median", "points.2");
  const Graph graph = net.Build();
  for (const auto& [height, width] : kSizes) {
    SCOPED_TRACE(testing::Message() << width << "x" << height);
    const PlainImage confidence = RandomImage({1, height, width}, -0.5f, 2, 2);
    ExpectEveryNodeRight(graph, {RandomImage({1, height, width}, -8, 12, 1), confidence},
                         options());
    PlainImage odd({1, height, width});  // none, or extreme ones
    ExpectEveryNodeRight(graph, {odd, confidence}, options());
    const double extremes[] = {1e-40,
                               3e38,
                               std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN(),
                               -1,
                               1e-45};
    for (std::size_t i = 0; i < odd.values.size(); ++i) {
      odd.values[i] = static_cast<float>(extremes[i % std::size(extremes)]);
    }
    ExpectEveryNodeRight(graph, {odd, RandomImage({1, height, width}, 0.1f, 1, 3)}, options());
  }
}

TEST_F(VulkanOperations, AreFunctionsWithinAFewUnitsInTheLastPlace) {
  NetworkBuilder net(1);
  net.Input("x", 1);
  using Function = double (*)(double);
  const std::pair<const char*, Function> functions[] = {
      {"exp", [](double x) { return std::exp(x); }},
      {"log", [](double x) { return std::log(x); }},
      {"tanh", [](double x) { return std::tanh(x); }},
      {"sigmoid", [](double x) { return 1 / (1 + std::exp(-x)); }},
      {"softplus", [](double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }}};
  for (const auto& [name, function] : functions) net.Output(net.Node(name, name, {"x"}), name);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PlainImage x({1, 60, 101});
  const PlainImage wide = RandomImage(x.shape, -88, 88, 1);
  const PlainImage narrow = RandomImage(x.shape, -1.5f, 1.5f, 2);
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    x.values[i] = i % 2 == 0 ? wide.values[i] : narrow.values[i];
  }
  const double special[] = {
      0,    1,     1 - 0x1p-24, 1 + 0x1p-23, 0x1p-30,
      1e38, 1e-38, kInfinity,   -kInfinity,  std::numeric_limits<double>::quiet_NaN()};
  for (std::size_t i = 0; i < std::size(special); ++i) {
    x.values[i] = static_cast<float>(special[i]);
  }
  const auto results = RunOnce(Executor(net.Build(), 60, 101, options()), {x});
  for (std::size_t f = 0; f < std::size(functions); ++f) {
    for (std::size_t i = 0; i < x.values.size(); ++i) {
      const double expected = functions[f].second(x.values[i]);
      const double actual = results[f][i];
      if (std::isnan(expected) || std::isinf(expected)) {
        EXPECT_TRUE(std::isnan(expected) ? std::isnan(actual) : actual == expected)
            << functions[f].first << '(' << x.values[i] << ") is " << actual;
        continue;
      }
      // Half a unit of 2^-24 for each of some operations. Below the smallest normal number a device
      // may give zero.
      const double allowed = 5 * 0x1p-23 * std::abs(expected) + 0x1p-126;
      ASSERT_LE(std::abs(actual - expected), allowed)
          << functions[f].first << '(' << x.values[i] << ") is " << actual;
    }
  }
}

TEST_F(VulkanOperations, OfRandomNetworksAgreeWithDoublePrecision) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    ExpectEveryNodeRight(RandomNetwork(25, seed).Build(), RandomInputs(8, 16, seed), options());
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace orb360::nn
