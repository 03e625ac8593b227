#include "nn/graph/fusion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/graph/network_builder.h"

namespace orb360::nn {
namespace {

using ::testing::ElementsAre;

// "node -> tensor" of each fused node, with what it adds and its slope.
std::vector<std::string> Describe(const NetworkBuilder& net) {
  const Graph graph = net.Build();
  std::vector<std::string> list;
  const auto name = [&](int tensor) {
    return graph.tensors[static_cast<std::size_t>(tensor)].name;
  };
  for (const FusedNode& fused : FuseNodes(graph)) {
    std::string text = fused.node.name + " -> " + name(fused.node.outputs[0]);
    if (fused.adds_residual) text += " + " + name(fused.node.inputs.back());
    if (fused.slope != 1) text += " slope " + std::to_string(fused.slope).substr(0, 4);
    list.push_back(text);
  }
  return list;
}

NetworkBuilder Start() {
  NetworkBuilder net;
  net.Input("x", 16);
  return net;
}

TEST(Fusion, AResidualBlockIsTwoSteps) {
  NetworkBuilder net = Start();
  net.Convolution("a", "x", 16, 16, 3);
  net.Node("b", "leaky_relu", {"a"}, {{"slope", 0.25}});
  net.Convolution("c", "b", 16, 16, 3);
  net.Node("d", "add", {"x", "c"});
  net.Node("e", "relu", {"d"});
  net.Output("e", "e");
  EXPECT_THAT(Describe(net), ElementsAre("a -> b slope 0.25", "c -> e + x slope 0.00"));
}

TEST(Fusion, WhatSomebodyElseReadsStays) {
  NetworkBuilder net = Start();
  net.Convolution("a", "x", 16, 16, 3);
  net.Node("b", "relu", {"a"});
  net.Node("c", "add", {"a", "b"});
  net.Output("c", "c");
  EXPECT_THAT(Describe(net), ElementsAre("a -> a", "b -> b", "c -> c"));
  NetworkBuilder shown = Start();
  shown.Convolution("a", "x", 16, 16, 3);
  shown.Node("b", "relu", {"a"});
  shown.Output("a", "a");
  shown.Output("b", "b");
  EXPECT_THAT(Describe(shown), ElementsAre("a -> a", "b -> b"));
}

TEST(Fusion, TheLaterOfTwoConvolutionsAdds) {
  NetworkBuilder net = Start();
  net.Convolution("a", "x", 16, 16, 3);
  net.Convolution("b", "x", 16, 16, 1);
  net.Node("c", "add", {"a", "b"});
  net.Output("c", "c");
  EXPECT_THAT(Describe(net), ElementsAre("a -> a", "b -> c + a"));
}

TEST(Fusion, WaitsForWhatItAdds) {
  NetworkBuilder net = Start();
  net.Convolution("a", "x", 16, 16, 1);
  net.Node("b", "tanh", {"x"});
  net.Node("c", "add", {"b", "a"});
  net.Output("c", "c");
  EXPECT_THAT(Describe(net), ElementsAre("b -> b", "a -> c + b"));
}

// Two levels of confidence propagation.
TEST(Fusion, NormalizedConvolutionsTakeInWhatSurroundsThem) {
  NetworkBuilder net(2);
  net.Input("x", 1);
  net.Input("c", 1);
  net.NormalizedConvolution("a", "x", "c", 1, 2, 5);
  net.NormalizedConvolution("b", "a", "a.1", 2, 2, 3);
  net.Node("pool", "confidence_pool", {"b", "b.1"}, {{"rule", "sqrt"}}, 2);
  net.NormalizedConvolution("d", "pool", "pool.1", 2, 2, 3);
  net.Node("up", "upsample_nearest", {"d"});
  net.Node("up.c", "upsample_nearest", {"d.1"});
  net.Node("both", "concatenate", {"b", "up"});
  net.Node("both.c", "concatenate", {"b.1", "up.c"});
  net.NormalizedConvolution("e", "both", "both.c", 4, 2, 3);
  net.NormalizedConvolution("f", "e", "e.1", 2, 1, 1);
  net.Output("x", "f");
  net.Output("c", "f.1");
  const Graph graph = net.Build();
  const std::vector<FusedNode> nodes = FuseNodes(graph);
  const auto names = [&](const std::vector<int>& tensors) {
    std::string list;
    for (const int tensor : tensors) {
      list += graph.tensors[static_cast<std::size_t>(tensor)].name + " ";
    }
    return list;
  };
  ASSERT_THAT(Describe(net), ElementsAre("a -> b", "d -> d", "e -> f"));
  EXPECT_EQ(nodes[0].chain.size(), 1u);
  EXPECT_EQ(names(nodes[0].node.outputs), "b b.1 pool pool.1 ");
  EXPECT_EQ(nodes[0].pool->rule, ConfidencePoolOp::Rule::kSqrt);
  EXPECT_EQ(names(nodes[2].node.inputs), "b b.1 d d.1 ");
  EXPECT_THAT(nodes[2].doubled, ElementsAre(false, true));
  EXPECT_EQ(nodes[2].chain.size(), 1u);
}

TEST(Fusion, ChainsBreakWhereSomebodyElseReads) {
  NetworkBuilder net;
  net.Input("x", 1);
  net.Input("c", 1);
  net.NormalizedConvolution("a", "x", "c", 1, 1, 3);
  net.NormalizedConvolution("b", "a", "a.1", 1, 1, 3);
  net.NormalizedConvolution("d", "b.1", "b", 1, 1, 3);  // the other way round
  net.Node("e", "tanh", {"a"});
  net.Output("d", "d");
  net.Output("e", "e");
  EXPECT_THAT(Describe(net), ElementsAre("a -> a", "b -> b", "d -> d", "e -> e"));
}

TEST(Fusion, LeavesOutWhatNobodyNeeds) {
  NetworkBuilder net = Start();
  net.Node("a", "tanh", {"x"});
  net.Node("b", "exp", {"a"});
  net.Node("c", "relu", {"x"});
  net.Output("c", "c");
  EXPECT_THAT(Describe(net), ElementsAre("c -> c"));
  EXPECT_EQ(KeepNodes(net.Build()).size(), 3u);
}

}  // namespace
}  // namespace orb360::nn
