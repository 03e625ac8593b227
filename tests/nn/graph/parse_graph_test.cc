#include "nn/graph/parse_graph.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/graph/network_builder.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Every kind of operation once, with a pyramid of two levels.
NetworkBuilder EveryOperation() {
  NetworkBuilder net(8);
  net.Input("image", 3);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("points", "median_log", {"depth", "confidence"}, json::object(), 3);
  net.NormalizedConvolution("n1", "points", "points.1", 1, 2, 5);
  net.Node("pooled", "confidence_pool", {"n1", "n1.1"}, {{"rule", "sqrt"}}, 2);
  net.Node("up", "upsample_nearest", {"pooled"});
  net.Node("latitude", "latitude_sine", {"depth"});
  net.Node("all", "concatenate", {"n1", "image", "latitude"});
  net.Convolution("e1", "all", 6, 20, 3, 2);
  net.Node("a1", "leaky_relu", {"e1"}, {{"slope", 0.1}});
  net.Node("half", "average_pool", {"a1"});
  net.Node("bilinear", "upsample_bilinear", {"half"}, {{"padding", "wrap_cross_pole"}});
  net.Node("sum", "add", {"a1", "bilinear"});
  net.Node("product", "multiply", {"sum", "a1"});
  net.Node("first", "slice", {"product"}, {{"first", 3}, {"count", 1}});
  net.Convolution("affinity", "product", 20, 9, 1);
  net.Node("filtered", "convex_upsample", {"first", "affinity"},
           {{"padding", "wrap_replicate"}, {"factor", 1}});
  net.Convolution("mask", "product", 20, 36, 1);
  net.Node("full", "convex_upsample", {"filtered", "mask"}, {{"padding", "wrap_replicate"}});
  net.Node("mean", "global_average_pool", {"product"});
  net.Dense("g", "mean", 20, 1);
  std::string last = "full";
  for (const char* const op : {"relu", "tanh", "sigmoid", "softplus", "exp", "log"}) {
    last = net.Node(op, op, {last});
  }
  last = net.Node("affine", "affine", {last}, {{"scale", 2}, {"offset", -0.5}});
  last = net.Node("clamp", "clamp", {last}, {{"minimum", -1}, {"maximum", 1}});
  net.Output("depth", last);
  net.Output("scale", "points.2");
  return net;
}

TEST(ParseGraph, InfersChannelsAndSizesOfEveryOperation) {
  const Graph graph = EveryOperation().Build();
  const auto shape = [&](const std::string& name) {
    for (const Tensor& tensor : graph.tensors) {
      if (tensor.name == name) return ShapeFor(tensor, 16, 32);
    }
    return Shape{};
  };
  EXPECT_EQ(shape("points.2"), (Shape{1, 1, 1}));
  EXPECT_EQ(shape("n1.1"), (Shape{2, 16, 32}));
  EXPECT_EQ(shape("pooled"), (Shape{2, 8, 16}));
  EXPECT_EQ(shape("up"), (Shape{2, 16, 32}));
  EXPECT_EQ(shape("all"), (Shape{6, 16, 32}));
  EXPECT_EQ(shape("e1"), (Shape{20, 8, 16}));
  EXPECT_EQ(shape("half"), (Shape{20, 4, 8}));
  EXPECT_EQ(shape("sum"), (Shape{20, 8, 16}));
  EXPECT_EQ(shape("first"), (Shape{1, 8, 16}));
  EXPECT_EQ(shape("mask"), (Shape{36, 8, 16}));
  EXPECT_EQ(shape("full"), (Shape{1, 16, 32}));
  EXPECT_EQ(shape("mean"), (Shape{20, 1, 1}));
  EXPECT_EQ(shape("g"), (Shape{1, 1, 1}));
  EXPECT_EQ(shape("clamp"), (Shape{1, 16, 32}));
  EXPECT_EQ(graph.size_multiple, 8);
  EXPECT_EQ(graph.outputs[1].name, "scale");
  EXPECT_EQ(graph.tensors[static_cast<std::size_t>(graph.outputs[1].tensor)].name, "points.2");
}

TEST(ParseGraph, KeepsAttributesAndText) {
  const Graph graph = EveryOperation().Build();
  for (const Node& node : graph.nodes) {
    EXPECT_EQ(node.name == "a1", std::holds_alternative<LeakyReluOp>(node.operation));
    if (const auto* relu = std::get_if<LeakyReluOp>(&node.operation)) {
      EXPECT_EQ(relu->slope, 0.1f);
    }
    if (const auto* pool = std::get_if<ConfidencePoolOp>(&node.operation)) {
      EXPECT_EQ(pool->rule, ConfidencePoolOp::Rule::kSqrt);
    }
    if (const auto* up = std::get_if<UpsampleBilinearOp>(&node.operation)) {
      EXPECT_EQ(up->padding, Padding::kWrapCrossPole);
    }
    if (const auto* slice = std::get_if<SliceOp>(&node.operation)) {
      EXPECT_EQ(slice->first, 3);
      EXPECT_EQ(slice->count, 1);
    }
  }
  EXPECT_EQ(json::parse(graph.provenance)["seed"], 1);
}

TEST(ParseGraph, CountsParametersAndMultiplications) {
  NetworkBuilder net;
  net.Input("x", 3);
  net.Convolution("y", "x", 3, 5, 3, 2);
  net.NormalizedConvolution("z", "x", "x", 3, 2, 1);
  net.Output("y", "y");
  const Graph graph = net.Build();
  EXPECT_EQ(CountParameters(graph), 3 * 5 * 9 + 5 + 3 * 2 + 2);
  EXPECT_EQ(MultiplyAdds(graph, graph.nodes[0], 7, 9), 3 * 5 * 9 * 4 * 5);
  EXPECT_EQ(MultiplyAdds(graph, graph.nodes[1], 7, 9), 2 * 3 * 2 * 7 * 9);
}

// The message of the refusal of a network changed by `damage`.
std::string Refusal(const std::function<void(NetworkBuilder*)>& damage) {
  NetworkBuilder net = EveryOperation();
  damage(&net);
  try {
    net.Build();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    return error.what();
  }
  return "accepted";
}

json* NodeNamed(NetworkBuilder* net, const std::string& name) {
  for (json& node : net->json["nodes"]) {
    if (node["name"] == name) return &node;
  }
  return nullptr;
}

TEST(ParseGraph, RefusesNodesWithTheirNameAndTheReason) {
  struct Case {
    const char* node;
    const char* patch;  // a JSON merge patch
    const char* reason;
  };
  const Case cases[] = {
      {"e1", R"({"op": "teleport"})", "unknown"},
      {"e1", R"({"op": 3})", "should be a string"},
      {"e1", R"({"attributes": {"stride": null}})", "no \"stride\""},
      {"e1", R"({"attributes": {"stride": 3}})", "integer from 1 to 2"},
      {"e1", R"({"attributes": {"stride": 1.5}})", "integer from 1 to 2"},
      {"e1", R"({"attributes": {"stride": 18446744073709551615}})", "integer from 1 to 2"},
      {"e1", R"({"attributes": {"padding": "mirror"}})", "should be one of zero, wrap_replicate"},
      {"e1", R"({"attributes": {"padding": 0}})", "should be a string"},
      {"e1", R"({"attributes": {"dilation": 1}})", "unknown \"dilation\""},
      {"e1", R"({"attributes": []})", "should be an object"},
      {"e1", R"({"comment": "x"})", "unknown \"comment\""},
      {"e1", R"({"inputs": ["all", "depth"]})", "has 2 inputs and should have 1"},
      {"e1", R"({"inputs": []})", "has 0 inputs"},
      {"e1", R"({"inputs": "all"})", "should be a list"},
      {"e1", R"({"inputs": [7]})", "should be a string"},
      {"e1", R"({"outputs": []})", "has 0 outputs"},
      {"e1", R"({"outputs": ["a", "b"]})", "at most 1"},
      {"e1", R"({"inputs": ["sum"]})", "\"sum\" is read, but nothing before has written it"},
      {"e1", R"({"inputs": ["e1"]})", "nothing before"},
      {"e1", R"({"outputs": ["all"]})", "written twice"},
      {"e1", R"({"outputs": ["image"]})", "written twice"},
      {"points", R"({"outputs": ["a", "a", "b"]})", "written twice"},
      {"e1", R"({"weights": {"bias": null}})", "no \"bias\""},
      {"e1", R"({"weights": {"weight": "none"}})", "\"none\" are not in the file"},
      {"e1", R"({"weights": {"weight": "e1.bias"}})", "are 20 and should be Ox6xKxK"},
      {"e1", R"({"weights": {"weight": "mask.weight"}})", "are 36x20x1x1"},
      {"e1", R"({"weights": {"bias": "mask.bias"}})", "are 36 and should be 20"},
      {"e1", R"({"weights": {"scale": "e1.bias"}})", "unknown \"scale\""},
      {"relu", R"({"weights": {"weight": "e1.bias"}})", "unknown \"weight\""},
      {"g", R"({"inputs": ["product"]})", "dense takes 1x1 only"},
      {"g", R"({"weights": {"weight": "e1.weight"}})", "should be Ox20"},
      {"mask", R"({"inputs": ["image"]})", "should be Ox3xKxK"},
      {"sum", R"({"inputs": ["a1", "half"]})", "\"half\" has 20 channels at 1/4 of the image"},
      {"sum", R"({"inputs": ["a1", "mean"]})", "nothing before"},
      {"all", R"({"inputs": ["n1", "pooled"]})", "\"pooled\" has 2 channels at 1/2"},
      {"all", R"({"inputs": []})", "should have 1 or more"},
      {"n1", R"({"inputs": ["points", "points.2"]})", "\"points.2\" has 1 channels at 1x1"},
      {"n1", R"({"inputs": ["points", "image"]})", "\"image\" has 3 channels"},
      {"n1", R"({"weights": {"weight": "e1.weight"}})", "should be Ox1xKxK"},
      {"points", R"({"inputs": ["image", "image"]})", "should have 1"},
      {"full", R"({"inputs": ["first", "product"]})", "should have 36"},
      {"full", R"({"inputs": ["product", "mask"]})", "should have 1"},
      {"full", R"({"inputs": ["latitude", "mask"]})", "\"mask\" has 36 channels at 1/2"},
      {"filtered", R"({"attributes": {"factor": 3}})", "integer from 1 to 2"},
      {"filtered", R"({"attributes": {"factor": 2}})", "should have 36"},
      {"pooled", R"({"attributes": {"rule": "half"}})", "should be one of quarter, sqrt"},
      {"pooled", R"({"inputs": ["points.2", "points.2"]})", "has no half"},
      {"up", R"({"inputs": ["points.2"]})", "not up-sampled"},
      {"first", R"({"attributes": {"first": 20}})", "channels 20 to 20 do not exist"},
      {"first", R"({"attributes": {"count": 18}})", "channels 3 to 20 do not exist"},
      {"first", R"({"attributes": {"count": 0}})", "integer from 1"},
      {"first", R"({"attributes": {"first": -1}})", "integer from 0"},
      {"clamp", R"({"attributes": {"minimum": 2}})", "minimum is above maximum"},
      {"affine", R"({"attributes": {"scale": 1e39}})", "fits 32 bits"},
      {"affine", R"({"attributes": {"scale": true}})", "should be a number"},
  };
  for (const auto& [node, patch, reason] : cases) {
    const std::string refusal = Refusal([node = node, patch = patch](NetworkBuilder* net) {
      NodeNamed(net, node)->merge_patch(json::parse(patch));
    });
    EXPECT_THAT(refusal, HasSubstr(reason)) << node << " " << patch;
    if (!json::parse(patch).contains("op") || json::parse(patch)["op"].is_string()) {
      EXPECT_THAT(refusal, HasSubstr(std::string("\"").append(node).append("\""))) << patch;
    }
  }
}

TEST(ParseGraph, RefusesWhatIsWrongWithTheWhole) {
  const auto patched = [](const char* patch) {
    return Refusal([&](NetworkBuilder* net) { net->json.merge_patch(json::parse(patch)); });
  };
  EXPECT_THAT(patched(R"({"size_multiple": 0})"), HasSubstr("integer from 1 to 4096"));
  EXPECT_THAT(patched(R"({"size_multiple": null})"), HasSubstr("no \"size_multiple\""));
  EXPECT_THAT(patched(R"({"inputs": []})"), HasSubstr("no inputs"));
  EXPECT_THAT(patched(R"({"outputs": []})"), HasSubstr("no outputs"));
  EXPECT_THAT(patched(R"({"nodes": {}})"), HasSubstr("should be a list"));
  EXPECT_THAT(patched(R"({"nodes": [1]})"), HasSubstr("node 0 should be an object"));
  EXPECT_THAT(patched(R"({"nodes": [{}]})"), HasSubstr("node 0 has no \"name\""));
  EXPECT_THAT(patched(R"({"name": "a\nb"})"), HasSubstr("without control characters"));
  EXPECT_THAT(patched(R"({"name": ""})"), HasSubstr("1 to 256 bytes"));
  EXPECT_THAT(patched(R"({"version": 2})"), HasSubstr("unknown \"version\""));
  EXPECT_THAT(patched(R"({"provenance": "by hand"})"), HasSubstr("should be an object"));
  EXPECT_THAT(patched(R"({"inputs": [{"name": "x", "channels": 4097}]})"),
              HasSubstr("integer from 1 to 4096"));
  EXPECT_THAT(patched(R"({"outputs": [{"name": "y", "tensor": "z"}]})"),
              HasSubstr("tensor \"z\" is read"));
  EXPECT_THAT(patched(R"({"outputs": [{"name": "y", "tensor": "sum"},
                                      {"name": "y", "tensor": "sum"}]})"),
              HasSubstr("two outputs"));
  EXPECT_THAT(
      Refusal([](NetworkBuilder* net) { net->json["nodes"].push_back(net->json["nodes"].back()); }),
      HasSubstr("two nodes have the name \"clamp\""));
  EXPECT_THAT(Refusal([](NetworkBuilder* net) { net->AddWeight("extra", {1}, 0, 1); }),
              HasSubstr("\"extra\" belong to no node"));
}

TEST(ParseGraph, RefusesTextThatIsNoGraph) {
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("null"),
        std::string("{\"name\": \"\xff\"}"), std::string(1 << 20, '['),
        "{\"provenance\":" + std::string(100, '[') + std::string(100, ']') + "}",
        std::string((4 << 20) + 1, ' ')}) {
    EXPECT_THROW(ParseGraph(text, {}), UserError) << text.substr(0, 40);
  }
}

TEST(ParseGraph, RefusesWeightsThatMakeNoSense) {
  const auto changed = [](const std::string& name, float value, bool changes_all = false) {
    return Refusal([&](NetworkBuilder* net) {
      for (Weight& weight : net->weights) {
        if (weight.name != name) continue;
        weight.values.back() = value;
        if (changes_all) weight.values.assign(weight.values.size(), value);
      }
    });
  };
  EXPECT_THAT(changed("e1.weight", std::numeric_limits<float>::infinity()),
              HasSubstr("\"e1.weight\" contain a number that is not finite"));
  EXPECT_THAT(changed("g.bias", std::numeric_limits<float>::quiet_NaN()), HasSubstr("not finite"));
  EXPECT_THAT(changed("n1.weight", -1e-9f), AllOf(HasSubstr("\"n1\""), HasSubstr("negative")));
  EXPECT_THAT(changed("n1.weight", 0, true), HasSubstr("add up to zero"));
  EXPECT_THAT(changed("n1.weight", 3e38f, true), HasSubstr("add up to infinity"));
  EXPECT_EQ(changed("e1.weight", -1e9f), "accepted");
}

TEST(ParseGraph, RefusesSizesThatAnOperationCouldMeetAndNotTake) {
  EXPECT_THAT(Refusal([](NetworkBuilder* net) { net->json["size_multiple"] = 2; }),
              AllOf(HasSubstr("\"half\""), HasSubstr("size_multiple must be a multiple of 4")));
  const auto build = [](int size_multiple, const auto& add) {
    NetworkBuilder net(size_multiple);
    net.Input("x", 1);
    add(&net);
    net.Output("x", "x");
    try {
      net.Build();
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  // Strided convolutions round up; what would have to invert that is refused.
  const auto strided = [](NetworkBuilder* net) { net->Convolution("a", "x", 1, 1, 3, 2); };
  EXPECT_EQ(build(1, strided), "accepted");
  const auto up = [&](NetworkBuilder* net) {
    strided(net);
    net->Node("b", "upsample_nearest", {"a"});
  };
  EXPECT_THAT(build(1, up), HasSubstr("rounded up"));
  EXPECT_THAT(build(3, up), HasSubstr("rounded up"));
  EXPECT_EQ(build(6, up), "accepted");
  const auto crossing = [&](NetworkBuilder* net) {
    strided(net);
    net->Convolution("b", "a", 1, 1, 3, 1, "wrap_cross_pole");
  };
  EXPECT_THAT(build(2, crossing), HasSubstr("needs an even width"));
  EXPECT_EQ(build(4, crossing), "accepted");
  // Beyond any image.
  const auto repeated = [](const char* op, int times) {
    return [=](NetworkBuilder* net) {
      std::string last = "x";
      for (int i = 0; i < times; ++i) last = net->Node(op + std::to_string(i), op, {last});
    };
  };
  EXPECT_EQ(build(1, repeated("upsample_nearest", 2)), "accepted");
  EXPECT_THAT(build(1, repeated("upsample_nearest", 3)), HasSubstr("too large"));
  EXPECT_EQ(build(4096, repeated("average_pool", 12)), "accepted");
  EXPECT_THAT(build(4096, repeated("average_pool", 13)), HasSubstr("size_multiple must be"));
}

}  // namespace
}  // namespace orb360::nn
