#include "nn/graph/input_ranges.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nn/base/cpu.h"
#include "nn/graph/cpu_needs.h"
#include "nn/graph/fusion.h"
#include "tests/nn/graph/network_builder.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/executor.h>

namespace orb360::nn {
namespace {

using testing::HasSubstr;

Graph Network() {
  NetworkBuilder net;
  net.Input("image", 3);
  net.Convolution("stem", "image", 3, 20, 3, 2);
  net.Convolution("deep", "stem", 20, 40, 3);
  net.Convolution("plain", "deep", 40, 40, 3);
  net.Convolution("flat", "plain", 40, 2, 1);
  net.Node("relu", "relu", {"flat"});
  net.Output("y", "relu");
  return net.Build();
}

std::string Refusal(const std::string& json) {
  Graph graph = Network();
  try {
    AddInputRanges(json, &graph);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(AddInputRanges, GivesEachConvolutionItsOwn) {
  Graph graph = Network();
  AddInputRanges(R"({"input_ranges": {"deep": [-0.5, 12.25], "flat": [0, 1]}})", &graph);
  ASSERT_TRUE(graph.nodes[1].input_range);
  EXPECT_EQ(graph.nodes[1].input_range->minimum, -0.5f);
  EXPECT_EQ(graph.nodes[1].input_range->maximum, 12.25f);
  EXPECT_TRUE(graph.nodes[3].input_range);
  EXPECT_FALSE(graph.nodes[0].input_range);
  EXPECT_FALSE(graph.nodes[2].input_range);
}

TEST(AddInputRanges, RefusesWhatIsNotAllowedInOneLine) {
  for (const auto& [json, reason] : std::vector<std::pair<std::string, std::string>>{
           {"", "not JSON"},
           {"[]", "quantization"},
           {R"({"input_ranges": {}, "more": 1})", "more"},
           {R"({"input_ranges": [1, 2]})", "should be an object"},
           {R"({"input_ranges": {"other": [0, 1]}})", "other"},
           {R"({"input_ranges": {"relu": [0, 1]}})", "no convolution"},
           {R"({"input_ranges": {"deep": [0]}})", "two finite numbers"},
           {R"({"input_ranges": {"deep": [0, 1e300]}})", "two finite numbers"},
           {R"({"input_ranges": {"deep": [0, "1"]}})", "two finite numbers"},
           {R"({"input_ranges": {"deep": [0, 0]}})", "contain zero"},
           {R"({"input_ranges": {"deep": [0.5, 1]}})", "contain zero"},
           {R"({"input_ranges": {"deep": [1, -1]}})", "contain zero"},
           {R"({"input_ranges": {"deep": [0, 1e-40]}})", "wide"},
           {R"({"input_ranges": {"deep": [-3e38, 3e38]}})", "wide"}}) {
    const std::string refusal = Refusal(json);
    EXPECT_THAT(refusal, HasSubstr(reason)) << json;
    EXPECT_EQ(refusal.find('\n'), std::string::npos) << json;
  }
}

TEST(AddInputRanges, DecidesTogetherWithTheChannelsWhatMultipliesInBytes) {
  Graph graph = Network();
  const std::string all = R"({"input_ranges": {"stem": [0, 1], "deep": [0, 9], "flat": [0, 9]}})";
  AddInputRanges(all, &graph);
  const std::vector<FusedNode> nodes = FuseNodes(graph);
  const std::vector<DataType> expected = {DataType::kFloat,   // an image
                                          DataType::kInt8,    // range, many channels
                                          DataType::kFloat,   // no range
                                          DataType::kFloat};  // few channels
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(ConvolutionType(graph, nodes[i], DataType::kInt8), expected[i]) << i;
    EXPECT_EQ(ConvolutionType(graph, nodes[i], DataType::kFloat), DataType::kFloat) << i;
  }
}

}  // namespace
}  // namespace orb360::nn
