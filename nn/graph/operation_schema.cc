#include "nn/graph/operation_schema.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "nn/graph/limits.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

template <typename Value>
using Choice = std::pair<const char*, Value>;

/// Returns the value for the word under `key`.
template <typename Value, std::size_t count>
Value Choose(JsonObject* attributes, const char* key,
             const std::array<Choice<Value>, count>& choices) {
  const std::string word = attributes->Name(key);
  std::string known;
  for (const auto& [name, value] : choices) {
    if (word == name) return value;
    known += known.empty() ? "" : ", ";
    known += name;
  }
  throw UserError(Quoted(key) + " is " + Quoted(word) + " and should be one of " + known);
}

Padding ReadPadding(JsonObject* attributes) {
  static constexpr std::array<Choice<Padding>, 3> kPaddings = {{
      {"zero", Padding::kZero},
      {"wrap_replicate", Padding::kWrapReplicate},
      {"wrap_cross_pole", Padding::kWrapCrossPole},
  }};
  return Choose(attributes, "padding", kPaddings);
}

Operation ReadConfidencePool(JsonObject* attributes) {
  using Rule = ConfidencePoolOp::Rule;
  static constexpr std::array<Choice<Rule>, 2> kRules = {
      {{"quarter", Rule::kQuarter}, {"sqrt", Rule::kSqrt}}};
  return ConfidencePoolOp{Choose(attributes, "rule", kRules)};
}

template <typename Op>
Operation ReadNothing(JsonObject*) {
  return Op{};
}

template <typename Op>
Operation ReadPadded(JsonObject* attributes) {
  return Op{ReadPadding(attributes)};
}

Operation ReadConvexUpsample(JsonObject* attributes) {
  ConvexUpsampleOp op{.padding = ReadPadding(attributes)};
  if (attributes->Has("factor")) op.factor = attributes->Integer("factor", 1, 2);
  return op;
}

Operation ReadConvolution(JsonObject* attributes) {
  return ConvolutionOp{attributes->Integer("stride", 1, 2), ReadPadding(attributes)};
}

Operation ReadLeakyRelu(JsonObject* attributes) { return LeakyReluOp{attributes->Number("slope")}; }

Operation ReadClamp(JsonObject* attributes) {
  return ClampOp{attributes->Number("minimum"), attributes->Number("maximum")};
}

Operation ReadAffine(JsonObject* attributes) {
  return AffineOp{attributes->Number("scale"), attributes->Number("offset")};
}

Operation ReadSlice(JsonObject* attributes) {
  return SliceOp{attributes->Integer("first", 0, limits::kChannels - 1),
                 attributes->Integer("count", 1, limits::kChannels)};
}

constexpr OperationSchema Unary(const char* name, Operation (*read)(JsonObject*)) {
  return {name, 1, 1, 1, false, read};
}

constexpr std::array<OperationSchema, std::variant_size_v<Operation>> kSchemas = {{
    {"normalized_convolution", 2, 2, 2, true, ReadPadded<NormalizedConvolutionOp>},
    {"confidence_pool", 2, 2, 2, false, ReadConfidencePool},
    {"convolution", 1, 1, 1, true, ReadConvolution},
    {"dense", 1, 1, 1, true, ReadNothing<DenseOp>},
    Unary("upsample_nearest", ReadNothing<UpsampleNearestOp>),
    Unary("upsample_bilinear", ReadPadded<UpsampleBilinearOp>),
    {"convex_upsample", 2, 2, 1, false, ReadConvexUpsample},
    Unary("average_pool", ReadNothing<AveragePoolOp>),
    Unary("global_average_pool", ReadNothing<GlobalAveragePoolOp>),
    Unary("relu", ReadNothing<ReluOp>),
    Unary("tanh", ReadNothing<TanhOp>),
    Unary("sigmoid", ReadNothing<SigmoidOp>),
    Unary("softplus", ReadNothing<SoftplusOp>),
    Unary("exp", ReadNothing<ExpOp>),
    Unary("log", ReadNothing<LogOp>),
    Unary("leaky_relu", ReadLeakyRelu),
    Unary("clamp", ReadClamp),
    Unary("affine", ReadAffine),
    {"add", 2, 2, 1, false, ReadNothing<AddOp>},
    {"multiply", 2, 2, 1, false, ReadNothing<MultiplyOp>},
    {"concatenate", 1, limits::kNodeInputs, 1, false, ReadNothing<ConcatenateOp>},
    Unary("slice", ReadSlice),
    {"median_log", 2, 2, 3, false, ReadNothing<MedianLogOp>},
    Unary("latitude_sine", ReadNothing<LatitudeSineOp>),
}};

}  // namespace

const OperationSchema& SchemaOf(const std::string& operation) {
  const auto* const found = std::ranges::find_if(
      kSchemas, [&](const OperationSchema& schema) { return operation == schema.name; });
  if (found == kSchemas.end())
    throw UserError("its operation " + Quoted(operation) + " is unknown");
  return *found;
}

}  // namespace orb360::nn
