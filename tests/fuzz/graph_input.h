#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// What the fuzzer changes: a table of weights, one "NAME SHAPE VALUE" a line with the shape as in
/// 4x3x3x3 and every number of it the same, then an empty line, then the JSON of a graph. It stands
/// for the content of a network file that is behind the digest.
struct GraphInput {
  std::vector<Weight> weights;
  std::string_view json;
};

/// Nothing where the table is not one that a file could hold, or larger than a fuzzer should make.
std::optional<GraphInput> ReadGraphInput(std::string_view text);

/// The same network, but for the values of its weights.
std::string WriteGraphInput(const std::vector<Weight>& weights, const std::string& json);

}  // namespace orb360::nn
