#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/graph/network_builder.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/precision.h>

namespace orb360::nn {
namespace {

Graph Network(bool has_ranges) {
  NetworkBuilder net;
  net.Input("x", 16);
  net.Convolution("c", "x", 16, 16, 3);
  net.Output("y", "c");
  Graph graph = net.Build();
  if (has_ranges) graph.nodes[0].input_range = InputRange{-1, 1};
  return graph;
}

constexpr MatrixUnits kAvx2;  // and older ones, and Arm's without dot product
constexpr MatrixUnits kCortexA76{.arm_dot_product = true};
constexpr MatrixUnits kCascadeLake{.avx512_vnni = true};
constexpr MatrixUnits kZen4{.avx512_bfloat16 = true, .avx512_vnni = true};
constexpr MatrixUnits kSapphireRapids{.amx = true, .avx512_bfloat16 = true, .avx512_vnni = true};

TEST(ChoosePrecision, TakesTheFastestTypeOfEachProcessorByItself) {
  const Graph with = Network(true);
  const Graph without = Network(false);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, with, kAvx2), DataType::kFloat);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, with, kCascadeLake), DataType::kInt8);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, with, kZen4), DataType::kInt8);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, with, kSapphireRapids), DataType::kBFloat16);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, with, kCortexA76), DataType::kInt8);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, without, kAvx2), DataType::kFloat);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, without, kCortexA76), DataType::kFloat);
  // VDPBF16PS is not faster than tiles of floats.
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, without, kZen4), DataType::kFloat);
  EXPECT_EQ(ChoosePrecision(Precision::kAuto, without, kSapphireRapids), DataType::kBFloat16);
}

TEST(ChoosePrecision, TakesTheNamedTypeOrSaysWhyItCannot) {
  const Graph with = Network(true);
  const auto refusal = [](Precision wanted, const Graph& graph, const MatrixUnits& units) {
    try {
      ChoosePrecision(wanted, graph, units);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const MatrixUnits& units : {kAvx2, kCortexA76, kCascadeLake, kZen4, kSapphireRapids}) {
    EXPECT_EQ(ChoosePrecision(Precision::kFloat, with, units), DataType::kFloat);
  }
  EXPECT_EQ(ChoosePrecision(Precision::kBFloat16, with, kZen4), DataType::kBFloat16);
  EXPECT_EQ(ChoosePrecision(Precision::kInt8, with, kSapphireRapids), DataType::kInt8);
  EXPECT_EQ(ChoosePrecision(Precision::kInt8, with, kCortexA76), DataType::kInt8);
  EXPECT_THAT(refusal(Precision::kBFloat16, with, kCascadeLake), testing::HasSubstr("AMX"));
  EXPECT_THAT(refusal(Precision::kBFloat16, with, kCortexA76), testing::HasSubstr("AMX"));
  EXPECT_THAT(refusal(Precision::kInt8, with, kAvx2), testing::HasSubstr("VNNI"));
  EXPECT_THAT(refusal(Precision::kInt8, Network(false), kZen4), testing::HasSubstr("quantize"));
}

}  // namespace
}  // namespace orb360::nn
