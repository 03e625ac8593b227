#include "nn/graph/cpu_backend.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "nn/base/check.h"
#include "nn/kernels/average_pool.h"
#include "nn/kernels/confidence_pool.h"
#include "nn/kernels/convex_upsample.h"
#include "nn/kernels/convolution.h"
#include "nn/kernels/copy_channels.h"
#include "nn/kernels/dense.h"
#include "nn/kernels/elementwise.h"
#include "nn/kernels/latitude_sine.h"
#include "nn/kernels/median_log.h"
#include "nn/kernels/normalized_convolution.h"
#include "nn/kernels/upsample.h"

namespace orb360::nn {
namespace {

using Layouts = PortNeeds::Layouts;
using Views = std::span<const TensorView>;

constexpr PortNeeds kPlanar{.layouts = Layouts::kPlanar};
constexpr PortNeeds kFree{};
constexpr PortNeeds kTied{.is_tied = true};

constexpr PortNeeds WithHalo(PortNeeds needs, int halo) {
  needs.halo = halo;
  return needs;
}

class Needs {
 public:
  Needs(const Graph& graph, const FusedNode& fused) : graph_(graph), fused_(fused) {}

  NodeNeeds operator()(const NormalizedConvolutionOp&) const {
    const int halo = KernelSize(graph_, fused_.node) / 2;
    return {{WithHalo(kPlanar, halo), WithHalo(kPlanar, halo)}, {kPlanar, kPlanar}, {}};
  }
  NodeNeeds operator()(const ConfidencePoolOp&) const {
    return {{kPlanar, kPlanar}, {kPlanar, kPlanar}, {}};
  }
  NodeNeeds operator()(const ConvolutionOp&) const {
    const int inputs = graph_.tensors[static_cast<std::size_t>(fused_.node.inputs[0])].channels;
    const PortNeeds input{
        .layouts = inputs <= kMaxPlanarChannels ? Layouts::kPlanar : Layouts::kBlocked,
        .halo = KernelSize(graph_, fused_.node) / 2};
    if (!fused_.adds_residual) return {{input}, {kTied}, {}};
    return {{input, kTied}, {kTied}, {1}};
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
  /// Functions of one number.
  template <typename Elementwise>
  NodeNeeds operator()(const Elementwise&) const {
    return {{kTied}, {kTied}, {0}};
  }

 private:
  const Graph& graph_;
  const FusedNode& fused_;
};

class StepMaker {
 public:
  StepMaker(const Graph& graph, const FusedNode& fused, int threads)
      : graph_(graph), fused_(fused), threads_(threads) {}

  Step operator()(const NormalizedConvolutionOp& op) const {
    const Weight& weight = this->weight(0);
    const auto kernel = std::make_shared<const NormalizedConvolution>(
        weight.values, this->weight(1).values, weight.shape[0], weight.shape[1], weight.shape[3],
        op.padding);
    return [kernel, threads = threads_](Views in, Views out) {
      kernel->Run(in[0], in[1], out[0], out[1], threads);
    };
  }
  Step operator()(const ConfidencePoolOp& op) const {
    const ConfidenceRule rule = op.rule == ConfidencePoolOp::Rule::kQuarter
                                    ? ConfidenceRule::kQuarter
                                    : ConfidenceRule::kSquareRoot;
    return [rule, threads = threads_](Views in, Views out) {
      ConfidencePool(in[0], in[1], out[0], out[1], rule, threads);
    };
  }
  Step operator()(const ConvolutionOp& op) const {
    const Weight& weight = this->weight(0);
    const ConvolutionSpec spec{.in_channels = weight.shape[1],
                               .out_channels = weight.shape[0],
                               .kernel = weight.shape[3],
                               .stride = op.stride,
                               .padding = op.padding,
                               .slope = fused_.slope};
    const auto kernel =
        std::make_shared<const Convolution>(spec, weight.values, this->weight(1).values);
    return [kernel, adds = fused_.adds_residual, threads = threads_](Views in, Views out) {
      kernel->Run(in[0], adds ? &in[1] : nullptr, out[0], threads);
    };
  }
  Step operator()(const DenseOp&) const {
    const Weight& weight = this->weight(0);
    const auto kernel = std::make_shared<const Dense>(weight.values, this->weight(1).values,
                                                      weight.shape[0], weight.shape[1]);
    return [kernel](Views in, Views out) { kernel->Run(in[0], out[0]); };
  }
  Step operator()(const UpsampleNearestOp&) const { return Simple(UpsampleNearest); }
  Step operator()(const UpsampleBilinearOp& op) const {
    return [padding = op.padding, threads = threads_](Views in, Views out) {
      UpsampleBilinear(in[0], out[0], padding, threads);
    };
  }
  Step operator()(const ConvexUpsampleOp& op) const {
    return [padding = op.padding, threads = threads_](Views in, Views out) {
      ConvexUpsample(in[0], in[1], out[0], padding, threads);
    };
  }
  Step operator()(const AveragePoolOp&) const { return Simple(AveragePool); }
  Step operator()(const GlobalAveragePoolOp&) const { return Simple(GlobalAveragePool); }
  Step operator()(const ReluOp&) const { return Simple(Relu); }
  Step operator()(const TanhOp&) const { return Simple(Tanh); }
  Step operator()(const SigmoidOp&) const { return Simple(Sigmoid); }
  Step operator()(const SoftplusOp&) const { return Simple(Softplus); }
  Step operator()(const ExpOp&) const { return Simple(Exp); }
  Step operator()(const LogOp&) const { return Simple(Log); }
  Step operator()(const LeakyReluOp& op) const {
    return [op, threads = threads_](Views in, Views out) {
      LeakyRelu(in[0], op.slope, out[0], threads);
    };
  }
  Step operator()(const ClampOp& op) const {
    return [op, threads = threads_](Views in, Views out) {
      Clamp(in[0], op.minimum, op.maximum, out[0], threads);
    };
  }
  Step operator()(const AffineOp& op) const {
    return [op, threads = threads_](Views in, Views out) {
      Affine(in[0], op.scale, op.offset, out[0], threads);
    };
  }
  Step operator()(const AddOp&) const { return OfTwo(Add); }
  Step operator()(const MultiplyOp&) const { return OfTwo(Multiply); }
  Step operator()(const MedianLogOp&) const {
    return [threads = threads_](Views in, Views out) {
      MedianLog(in[0], in[1], out[0], out[1], out[2], threads);
    };
  }
  Step operator()(const LatitudeSineOp&) const {
    return [](Views, Views out) { LatitudeSine(out[0]); };
  }
  Step operator()(const ConcatenateOp&) const { return NotHere(); }
  Step operator()(const SliceOp&) const { return NotHere(); }

 private:
  const Weight& weight(std::size_t i) const {
    return graph_.weights[static_cast<std::size_t>(fused_.node.weights[i])];
  }
  Step Simple(void (*function)(const TensorView&, const TensorView&, int)) const {
    return
        [function, threads = threads_](Views in, Views out) { function(in[0], out[0], threads); };
  }
  Step OfTwo(void (*function)(const TensorView&, const TensorView&, const TensorView&, int)) const {
    return [function, threads = threads_](Views in, Views out) {
      function(in[0], in[1], out[0], threads);
    };
  }
  static Step NotHere() {
    ORB360_CHECK(false, "views and copies are not for a backend");
    return {};
  }

  const Graph& graph_;
  const FusedNode& fused_;
  int threads_;
};

}  // namespace

NodeNeeds CpuBackend::NeedsOf(const Graph& graph, const FusedNode& node) const {
  return std::visit(Needs(graph, node), node.node.operation);
}

Step CpuBackend::MakeStep(const Graph& graph, const FusedNode& node) const {
  return std::visit(StepMaker(graph, node, threads_), node.node.operation);
}

Step CpuBackend::MakeCopy(int from_first, int to_first, int count) const {
  return [=, threads = threads_](Views in, Views out) {
    CopyChannels(in[0], from_first, out[0], to_first, count, threads);
  };
}

}  // namespace orb360::nn
