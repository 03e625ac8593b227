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
