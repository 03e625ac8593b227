#include "nn/graph/lowering.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "nn/graph/formats.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

Format FormatOf(const Value& value) { return {value.format.layout, value.format.type}; }

class Lowering {
 public:
  Lowering(const Graph& graph, std::span<const FusedNode> nodes, const Backend& backend, int height,
           int width)
      : graph_(graph),
        height_(height),
        width_(width),
        nodes_(nodes),
        needs_(CollectNeeds(graph, nodes, backend)),
        formats_(ChooseFormats(graph, nodes, needs_)),
        copies_(graph.tensors.size()) {
    lowered_.value_of_tensor.assign(graph.tensors.size(), -1);
  }

  Lowered Run() {
    for (const int tensor : graph_.inputs) lowered_.inputs.push_back(AddTensor(tensor));
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i].node;
      if (std::holds_alternative<ConcatenateOp>(node.operation)) {
        AddConcatenation(node);
      } else if (const auto* slice = std::get_if<SliceOp>(&node.operation)) {
        AddSlice(node, *slice);
      } else {
        AddNode(i);
      }
    }
    for (const Graph::Output& output : graph_.outputs) {
      lowered_.outputs.push_back(ValueOf(output.tensor));
    }
    return std::move(lowered_);
  }

 private:
  Value& value(int index) { return lowered_.values[Index(index)]; }
  int ValueOf(int tensor) const { return lowered_.value_of_tensor[Index(tensor)]; }

  int AddValue(int tensor, const Format& format) {
    const Shape shape = ShapeFor(graph_.tensors[Index(tensor)], height_, width_);
    lowered_.values.push_back({tensor, {shape, format.layout, format.type, 0}});
    return static_cast<int>(lowered_.values.size()) - 1;
  }
  int AddTensor(int tensor) {
    return lowered_.value_of_tensor[Index(tensor)] = AddValue(tensor, formats_[Index(tensor)]);
  }
  void AddCopy(int from, int from_first, int to, int to_first, int count) {
    lowered_.instructions.push_back({"copy of " + graph_.tensors[Index(value(from).tensor)].name,
                                     ChannelCopy{from_first, to_first, count},
                                     {from},
                                     {to},
                                     {}});
  }

  /// Returns the tensor in the format that an input of a node needs. A copy serves several readers.
  int ForInput(int tensor, const PortNeeds& needs, const Format& of_result) {
    const int written = ValueOf(tensor);
    Format format = needs.is_tied ? of_result : FormatOf(value(written));
    if (needs.layouts == PortNeeds::Layouts::kPlanar) format.layout = Layout::kPlanar;
    if (needs.layouts == PortNeeds::Layouts::kBlocked) format.layout = Layout::kBlocked;
    if (needs.types == PortNeeds::Types::kFloat) format.type = DataType::kFloat;
    if (needs.types == PortNeeds::Types::kBFloat16) format.type = DataType::kBFloat16;
    const int found = format == FormatOf(value(written)) ? written : CopyIn(tensor, format);
    value(found).format.halo = std::max(value(found).format.halo, needs.halo);
    return found;
  }
  int CopyIn(int tensor, const Format& format) {
    for (const int copy : copies_[Index(tensor)]) {
      if (FormatOf(value(copy)) == format) return copy;
    }
    const int copy = AddValue(tensor, format);
    AddCopy(ValueOf(tensor), 0, copy, 0, value(copy).format.shape.channels);
    copies_[Index(tensor)].push_back(copy);
    return copy;
  }

  void AddNode(std::size_t index) {
    const Node& node = nodes_[index].node;
    const NodeNeeds& needs = needs_[index];
    const Format of_result = formats_[Index(node.outputs.front())];
    Instruction instruction{node.name, index, {}, {}, needs.replaceable};
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
      instruction.inputs.push_back(ForInput(node.inputs[i], needs.inputs[i], of_result));
    }
    for (const int tensor : node.outputs) instruction.outputs.push_back(AddTensor(tensor));
    lowered_.instructions.push_back(std::move(instruction));
  }

  void AddConcatenation(const Node& node) {
    const int whole = AddTensor(node.outputs.front());
    const Format format = FormatOf(value(whole));
    const int all = value(whole).format.shape.channels;
    int first = 0;
    for (const int tensor : node.inputs) {
      Value& part = value(ValueOf(tensor));
      const int count = part.format.shape.channels;
      // In this case its writer writes directly into the whole. A tensor that is already a part of
      // another one is copied.
      if (part.whole < 0 && FormatOf(part) == format &&
          IsViewOfChannels(format, all, first, count)) {
        part.whole = whole;
        part.first_channel = first;
      } else {
        AddCopy(ValueOf(tensor), 0, whole, first, count);
      }
      first += count;
    }
  }

  void AddSlice(const Node& node, const SliceOp& op) {
    const int from = ValueOf(node.inputs.front());
    const int slice = AddTensor(node.outputs.front());
    const bool is_view = FormatOf(value(slice)) == FormatOf(value(from)) &&
                         IsViewOfChannels(FormatOf(value(from)), value(from).format.shape.channels,
                                          op.first, op.count);
    if (is_view) {
      value(slice).whole = from;
      value(slice).first_channel = op.first;
    } else {
      AddCopy(from, op.first, slice, 0, op.count);
    }
  }

  const Graph& graph_;
  const int height_;
  const int width_;
  const std::span<const FusedNode> nodes_;
  const std::vector<NodeNeeds> needs_;
  const std::vector<Format> formats_;
  std::vector<std::vector<int>> copies_;  // by tensor: its values in other formats
  Lowered lowered_;
};

}  // namespace

Lowered Lower(const Graph& graph, std::span<const FusedNode> nodes, const Backend& backend,
              int height, int width) {
  return Lowering(graph, nodes, backend, height, width).Run();
}

}  // namespace orb360::nn
