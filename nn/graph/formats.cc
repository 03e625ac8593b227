#include "nn/graph/formats.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace orb360::nn {
namespace {

using Layouts = PortNeeds::Layouts;
using Types = PortNeeds::Types;

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

/// The format that the readers of a tensor want.
struct Wish {
  std::optional<Layout> layout;
  std::optional<DataType> type;
};

Wish WishOf(const PortNeeds& port, const Wish& of_result) {
  Wish wish = port.is_tied ? of_result : Wish{};
  if (port.layouts == Layouts::kPlanar) wish.layout = Layout::kPlanar;
  if (port.layouts == Layouts::kBlocked) wish.layout = Layout::kBlocked;
  if (port.types == Types::kFloat) wish.type = DataType::kFloat;
  if (port.types == Types::kBFloat16) wish.type = DataType::kBFloat16;
  return wish;
}

/// With at most this many channels, a block of channels is at least half empty, and planes are
/// better.
constexpr int kFewChannels = BlockOf(DataType::kFloat) / 2;

Layout UsualLayout(int channels) {
  return channels <= kFewChannels ? Layout::kPlanar : Layout::kBlocked;
}

class Choice {
 public:
  Choice(const Graph& graph, std::span<const FusedNode> nodes, std::span<const NodeNeeds> needs)
      : graph_(graph), nodes_(nodes), needs_(needs), wishes_(graph.tensors.size()) {}

  std::vector<Format> Run() {
    for (std::size_t i = nodes_.size(); i-- > 0;) CollectWishes(i);
    formats_.resize(graph_.tensors.size());
    for (const int tensor : graph_.inputs) {
      formats_[Index(tensor)].layout = wishes_[Index(tensor)].layout.value_or(Layout::kPlanar);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) ChooseOutputs(i);
    return std::move(formats_);
  }

 private:
  int channels(int tensor) const { return graph_.tensors[Index(tensor)].channels; }

  void CollectWishes(std::size_t i) {
    const Node& node = nodes_[i].node;
    Wish of_result = wishes_[Index(node.outputs.front())];
    if (const auto* slice = std::get_if<SliceOp>(&node.operation)) {
      const Format blocked{Layout::kBlocked, of_result.type.value_or(DataType::kFloat)};
      if (!IsViewOfChannels(blocked, channels(node.inputs[0]), slice->first, slice->count)) {
        of_result.layout = Layout::kPlanar;  // any slice of planes is a view
      }
    }
    for (std::size_t port = 0; port < node.inputs.size(); ++port) {
      Vote(node.inputs[port], WishOf(needs_[i].inputs[port], of_result));
    }
  }

  void Vote(int tensor, const Wish& vote) {
    Wish& wish = wishes_[Index(tensor)];
    if (vote.layout && wish.layout != UsualLayout(channels(tensor))) wish.layout = vote.layout;
    if (vote.type && wish.type != DataType::kBFloat16) wish.type = vote.type;
  }

  Format Wished(int tensor) const {
    const Wish& wish = wishes_[Index(tensor)];
    return {wish.layout.value_or(UsualLayout(channels(tensor))),
            wish.type.value_or(DataType::kFloat)};
  }

  void ChooseOutputs(std::size_t i) {
    const Node& node = nodes_[i].node;
    const std::optional<Format> of_inputs = CommonFormatOfTiedInputs(i);
    for (std::size_t port = 0; port < node.outputs.size(); ++port) {
      const int tensor = node.outputs[port];
      const PortNeeds& needs = needs_[i].outputs[port];
      Format format = needs.is_tied && of_inputs ? *of_inputs : Wished(tensor);
      if (const auto* slice = std::get_if<SliceOp>(&node.operation)) {
        const int whole = channels(node.inputs[0]);
        if (!IsViewOfChannels(format, whole, slice->first, slice->count)) format = Wished(tensor);
      }
      if (needs.layouts == Layouts::kPlanar) format.layout = Layout::kPlanar;
      if (needs.layouts == Layouts::kBlocked) format.layout = Layout::kBlocked;
      if (needs.types == Types::kFloat) format.type = DataType::kFloat;
      if (needs.types == Types::kBFloat16) format.type = DataType::kBFloat16;
      // Only convolutions use bfloat16, and they read blocks.
      if (format.layout == Layout::kPlanar) format.type = DataType::kFloat;
      formats_[Index(tensor)] = format;
    }
  }

  std::optional<Format> CommonFormatOfTiedInputs(std::size_t i) const {
    std::optional<Format> common;
    for (std::size_t port = 0; port < needs_[i].inputs.size(); ++port) {
      if (!needs_[i].inputs[port].is_tied) continue;
      const Format& format = formats_[Index(nodes_[i].node.inputs[port])];
      if (common && *common != format) return {};
      common = format;
    }
    return common;
  }

  const Graph& graph_;
  const std::span<const FusedNode> nodes_;
  const std::span<const NodeNeeds> needs_;
  std::vector<Wish> wishes_;     // by tensor
  std::vector<Format> formats_;  // likewise
};

}  // namespace

std::vector<NodeNeeds> CollectNeeds(const Graph& graph, std::span<const FusedNode> nodes,
                                    const Backend& backend) {
  std::vector<NodeNeeds> needs;
  for (const FusedNode& fused : nodes) {
    const Operation& operation = fused.node.operation;
    if (std::holds_alternative<ConcatenateOp>(operation) ||
        std::holds_alternative<SliceOp>(operation)) {
      const PortNeeds any{.types = Types::kEither, .is_tied = true};
      needs.push_back({std::vector<PortNeeds>(fused.node.inputs.size(), any), {any}, {}});
    } else {
      needs.push_back(backend.NeedsOf(graph, fused));
    }
  }
  return needs;
}

std::vector<Format> ChooseFormats(const Graph& graph, std::span<const FusedNode> nodes,
                                  std::span<const NodeNeeds> needs) {
  return Choice(graph, nodes, needs).Run();
}

bool IsViewOfChannels(const Format& format, int channels, int first, int count) {
  if (format.layout == Layout::kPlanar) return true;
  const int block = BlockOf(format.type);
  // The last block of a view must be filled up with zeros, not with channels of another tensor.
  return first % block == 0 && (count % block == 0 || first + count == channels);
}

}  // namespace orb360::nn
