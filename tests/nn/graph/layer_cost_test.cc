#include "nn/graph/layer_cost.h"

#include <gtest/gtest.h>

#include "tests/nn/graph/network_builder.h"

namespace orb360::nn {
namespace {

TEST(LayerCost, CountsWhatAPassComputesAndMoves) {
  NetworkBuilder net(2);
  net.Input("x", 3);
  net.Convolution("y", "x", 3, 5, 3, 2);
  net.Node("z", "relu", {"y"});
  net.NormalizedConvolution("n", "x", "x", 3, 2, 5);
  net.Node("both", "concatenate", {"z", "z"});
  for (const char* name : {"both", "n", "n.1"}) net.Output(name, name);
  const Graph graph = net.Build();
  const std::vector<FusedNode> nodes = FuseConvolutions(graph);
  ASSERT_EQ(nodes.size(), 3u);  // the ReLU is a part of the convolution
  const std::vector<LayerCost> costs = LayerCosts(graph, nodes, 4, 8);
  // Of 2 x 4 pixels: 5 sums of 27 products, and the bias of each.
  EXPECT_EQ(costs[0].operations, 2 * 8 * 5 * 27 + 8 * 5);
  EXPECT_EQ(costs[0].bytes, 4 * (3 * 32 + 5 * 8 + 5 * 27 + 5));
  // Of 4 x 8 pixels: two sums, and two outputs of two channels.
  EXPECT_EQ(costs[1].operations, 2 * 2 * 32 * 2 * 75 + 2 * 2 * 32);
  EXPECT_EQ(costs[1].bytes, 4 * (2 * 3 * 32 + 2 * 2 * 32 + 2 * 75 + 2));
  EXPECT_EQ(costs[2].operations, 0);
  EXPECT_EQ(costs[2].bytes, 0);
}

TEST(LayerCost, TakesTheLongerOneOfComputingAndMoving) {
  EXPECT_DOUBLE_EQ(RooflineSeconds({.operations = 300, .bytes = 100}, 100, 50), 3);
  EXPECT_DOUBLE_EQ(RooflineSeconds({.operations = 300, .bytes = 500}, 100, 50), 10);
}

}  // namespace
}  // namespace orb360::nn
