// Convolutions with every tile.

#include <array>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "nn/vulkan/tiles.h"
#include "tests/nn/graph/network_builder.h"
#include "tests/nn/graph/network_run.h"
#include "tests/nn/vulkan/vulkan_fixture.h"

namespace orb360::nn {
namespace {

using VulkanTiles = VulkanTest;
using enum VulkanDevice::Type;

constexpr VulkanDevice::Type kTypes[] = {kDiscrete, kIntegrated, kVirtual, kCpu, kOther};

struct Case {
  Shape input;
  int outputs;
  int kernel;
  int stride;
};
// From one that has enough workgroups of the largest tile on an integrated device to one pixel.
constexpr Case kCases[] = {
    {{3, 32, 512}, 33, 3, 1}, {{2, 24, 512}, 20, 3, 1}, {{5, 33, 257}, 20, 5, 2},
    {{9, 20, 130}, 17, 3, 1}, {{4, 32, 64}, 16, 3, 1},  {{4, 16, 64}, 16, 3, 1},
    {{33, 8, 48}, 24, 1, 1},  {{20, 7, 19}, 9, 3, 2},   {{6, 5, 9}, 3, 5, 1},
    {{2, 1, 1}, 1, 3, 1},
};

Shape OutputOf(const Case& c) {
  const auto halved = [&](int size) { return (size + c.stride - 1) / c.stride; };
  return {c.outputs, halved(c.input.height), halved(c.input.width)};
}

TEST_F(VulkanTiles, ChangeNoBitAndAgreeWithTheCpu) {
  std::set<std::array<int, 4>> tiles;
  for (const Case& c : kCases) {
    NetworkBuilder net(1);
    net.Input("x", c.input.channels);
    net.Convolution("y", "x", c.input.channels, c.outputs, c.kernel, c.stride);
    net.Node("z", "leaky_relu", {"y"}, {{"slope", 0.3}});
    net.Output("z", "z");
    const Graph graph = net.Build();
    const auto [channels, height, width] = c.input;
    SCOPED_TRACE(testing::Message() << channels << "x" << height << "x" << width);
    const std::vector<PlainImage> inputs = {RandomImage(c.input, -1, 1, 1)};
    const std::vector<float> expected = RunOnce(Executor(graph, height, width), inputs)[0];
    std::vector<float> first;
    for (const VulkanDevice::Type type : kTypes) {
      const vulkan::ConvolutionTile tile =
          vulkan::ChooseTile(type, c.kernel, c.stride, channels, OutputOf(c));
      tiles.insert({tile.width, tile.height, tile.columns, tile.vectors});
      const Device device = OpenWith(vulkan::VulkanBackendOptions{.tiles_for = type});
      const std::vector<float> actual =
          RunOnce(Executor(graph, height, width, {.device = device}), inputs)[0];
      if (first.empty()) first = actual;
      EXPECT_TRUE(actual == first) << NameOf(type);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_NEAR(actual[i], expected[i], 1e-5) << NameOf(type) << ' ' << i;
      }
    }
  }
  EXPECT_EQ(tiles.size(), vulkan::kTileCount) << "some are not tested";
}

TEST(ChooseTile, KeepsTheLimitsOfEveryDevice) {
  for (const VulkanDevice::Type type : kTypes) {
    for (const int kernel : {1, 3, 5}) {
      for (const int stride : {1, 2}) {
        for (const int side : {1, 8, 64, 1024}) {
          const vulkan::ConvolutionTile tile =
              vulkan::ChooseTile(type, kernel, stride, 64, {64, side, 2 * side});
          EXPECT_LE(tile.width * tile.height, vulkan::kMaxInvocations);
          const int in_width = (tile.width * tile.columns - 1) * stride + kernel;
          const int in_height = (tile.height - 1) * stride + kernel;
          EXPECT_LE(4 * in_width * in_height * tile.chunk, vulkan::kMaxSharedBytes);
          EXPECT_GE(tile.chunk, 1);
        }
      }
    }
  }
}

}  // namespace
}  // namespace orb360::nn
