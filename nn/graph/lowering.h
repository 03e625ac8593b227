#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "nn/graph/backend.h"
#include "nn/graph/fusion.h"
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// A tensor of the graph in one format, for one image size.
struct Value {
  int tensor = 0;
  TensorFormat format;  // with the halo that its readers need
  /// Index of the value of which this one is a part (a member of a concatenation, or a slice), and
  /// the first channel there; -1 for a value with memory of its own.
  int whole = -1;
  int first_channel = 0;
};

/// Copies `count` channels of the only input to the only output, between any formats.
struct ChannelCopy {
  int from_first = 0;
  int to_first = 0;
  int count = 0;
};

/// One step of a run and the values that it reads and writes.
struct Instruction {
  std::string name;  // of the node, or of the tensor that is copied
  /// Index of the node, or what is copied.
  std::variant<std::size_t, ChannelCopy> work;
  std::vector<int> inputs;       // indices of values
  std::vector<int> outputs;      // likewise; several instructions may fill parts of one value
  std::vector<int> replaceable;  // NodeNeeds::replaceable
};

/// A graph as a list of instructions, before memory is assigned.
struct Lowered {
  std::vector<Value> values;
  std::vector<Instruction> instructions;
  std::vector<int> inputs;           // values, in the graph's order
  std::vector<int> outputs;          // likewise
  std::vector<int> value_of_tensor;  // -1 for a tensor that fusion has left out
};

/// Chooses formats, and adds copies where a reader needs another format than was written, and where
/// a concatenation or a slice cannot be a view.
Lowered Lower(const Graph& graph, std::span<const FusedNode> nodes, const Backend& backend,
              int height, int width);

}  // namespace orb360::nn
