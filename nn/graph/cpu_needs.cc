#include "nn/graph/cpu_needs.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "nn/kernels/convex_upsample.h"
#include "nn/kernels/convolution.h"
#include "nn/kernels/upsample.h"

namespace orb360::nn {
namespace {

using Layouts = PortNeeds::Layouts;
using Types = PortNeeds::Types;

constexpr PortNeeds kPlanar{.layouts = Layouts::kPlanar};
constexpr PortNeeds kFree{};
constexpr PortNeeds kTied{.is_tied = true};

constexpr PortNeeds WithHalo(PortNeeds needs, int halo) {
  needs.halo = halo;
  return needs;
}

class Needs {
 public:
  Needs(const Graph& graph, const FusedNode& fused, DataType precision)
      : graph_(graph), fused_(fused), precision_(precision) {}

  NodeNeeds operator()(const NormalizedConvolutionOp&) const {
    return {std::vector<PortNeeds>(fused_.node.inputs.size(), kPlanar),
            std::vector<PortNeeds>(fused_.node.outputs.size(), kPlanar),
            {}};
  }
  NodeNeeds operator()(const ConfidencePoolOp&) const {
    return {{kPlanar, kPlanar}, {kPlanar, kPlanar}, {}};
  }
  NodeNeeds operator()(const ConvolutionOp&) const {
    const bool is_image = channels(fused_.node.inputs[0]) <= kMaxPlanarChannels;
    PortNeeds input{.layouts = is_image ? Layouts::kPlanar : Layouts::kBlocked,
                    .halo = KernelSize(graph_, fused_.node) / 2};
    PortNeeds output = kTied;
    if (ConvolutionType(graph_, fused_, precision_) == DataType::kBFloat16) {
      if (is_image)
        return {{input}, {{.layouts = Layouts::kBlocked, .types = Types::kBFloat16}}, {}};
      input.types = Types::kBFloat16;
      output.types = Types::kEither;
    }
    if (!fused_.adds_residual) return {{input}, {output}, {}};
    return {{input, output}, {output}, {1}};
  }
  NodeNeeds operator()(const DenseOp&) const { return {{kFree}, {kFree}, {}}; }
  NodeNeeds operator()(const GlobalAveragePoolOp&) const { return {{kFree}, {kFree}, {}}; }
  NodeNeeds operator()(const UpsampleNearestOp&) const { return {{kTied}, {kTied}, {}}; }
  NodeNeeds operator()(const UpsampleBilinearOp&) const {
    return {{WithHalo(kTied, kUpsampleBilinearHalo)}, {kTied}, {}};
  }
  NodeNeeds operator()(const ConvexUpsampleOp&) const {
    return {{WithHalo(kPlanar, kConvexUpsampleHalo), kPlanar}, {kPlanar}, {}};
  }
  NodeNeeds operator()(const AveragePoolOp&) const { return {{kTied}, {kTied}, {}}; }
  NodeNeeds operator()(const AddOp&) const { return {{kTied, kTied}, {kTied}, {0, 1}}; }
  NodeNeeds operator()(const MultiplyOp&) const { return {{kTied, kTied}, {kTied}, {0, 1}}; }
  NodeNeeds operator()(const MedianLogOp&) const {
    return {{kPlanar, kPlanar}, {kPlanar, kPlanar, kPlanar}, {}};
  }
  NodeNeeds operator()(const LatitudeSineOp&) const { return {{kFree}, {kFree}, {}}; }
  /// Element-wise functions of one tensor.
  template <typename Elementwise>
  NodeNeeds operator()(const Elementwise&) const {
    return {{kTied}, {kTied}, {0}};
  }

 private:
  int channels(int tensor) const {
    return graph_.tensors[static_cast<std::size_t>(tensor)].channels;
  }

  const Graph& graph_;
  const FusedNode& fused_;
  const DataType precision_;
};

}  // namespace

NodeNeeds CpuNeedsOf(const Graph& graph, const FusedNode& node, DataType precision) {
  return std::visit(Needs(graph, node, precision), node.node.operation);
}

DataType ConvolutionType(const Graph& graph, const FusedNode& node, DataType precision) {
  const auto channels = [&](int tensor) {
    return graph.tensors[static_cast<std::size_t>(tensor)].channels;
  };
  if (precision == DataType::kInt8) {
    // Images and positions have more digits than 8 bits, and few channels do not fill a block. A
    // convolution whose accuracy would suffer has no range.
    const bool is_deep = std::min(channels(node.node.inputs[0]), channels(node.node.outputs[0])) >
                         kMaxPlanarChannels;
    return is_deep && node.node.input_range ? DataType::kInt8 : DataType::kFloat;
  }
  const bool stays_float =
      channels(node.node.inputs[0]) <= kMaxPlanarChannels &&
      (node.adds_residual || channels(node.node.outputs[0]) <= kMaxPlanarChannels);
  return stays_float ? DataType::kFloat : precision;
}

}  // namespace orb360::nn
