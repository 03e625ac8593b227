#include "nn/graph/input_ranges.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "nn/graph/json_object.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

float ToFinite(const nlohmann::json& value, const std::string& node) {
  const float number = value.is_number() ? value.get<float>() : NAN;
  if (!std::isfinite(number)) {
    throw UserError("\"quantization\": the range of node " + Quoted(node) +
                    " should be two finite numbers");
  }
  return number;
}

}  // namespace

void AddInputRanges(std::string_view json, Graph* graph) {
  const nlohmann::json root = nlohmann::json::parse(json, nullptr, /*allow_exceptions=*/false);
  if (root.is_discarded()) throw UserError("\"quantization\" is not JSON");
  JsonObject quantization(root, "\"quantization\"");
  const nlohmann::json& ranges = quantization.Get("input_ranges");
  quantization.CheckAllRead();
  if (!ranges.is_object()) throw UserError("\"input_ranges\" should be an object");
  for (const auto& [name, range] : ranges.items()) {
    const auto node = std::ranges::find(graph->nodes, name, &Node::name);
    if (node == graph->nodes.end() || !std::holds_alternative<ConvolutionOp>(node->operation)) {
      throw UserError("\"quantization\" has a range of " + Quoted(name) +
                      ", which is no convolution");
    }
    const nlohmann::json none;
    const bool is_pair = range.is_array() && range.size() == 2;
    const InputRange read{ToFinite(is_pair ? range[0] : none, name),
                          ToFinite(is_pair ? range[1] : none, name)};
    if (!(read.minimum <= 0 && read.maximum > 0)) {
      throw UserError("\"quantization\": the range of node " + Quoted(name) +
                      " should contain zero and end above it");
    }
    // Far beyond any network; scales within are normal numbers.
    constexpr float kNarrowest = 1e-20f, kWidest = 1e20f;
    const float width = read.maximum - read.minimum;
    if (!(width >= kNarrowest && width <= kWidest)) {
      throw UserError("\"quantization\": the range of node " + Quoted(name) +
                      " should be 1e-20 to 1e20 wide");
    }
    node->input_range = read;
  }
}

}  // namespace orb360::nn
