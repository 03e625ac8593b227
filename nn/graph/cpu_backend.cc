#include "nn/graph/cpu_backend.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "nn/base/cpu.h"
#include "nn/graph/cpu_needs.h"
#include "nn/graph/cpu_program.h"
#include "nn/kernels/average_pool.h"
#include "nn/kernels/confidence_pool.h"
#include "nn/kernels/convex_upsample.h"
#include "nn/kernels/convolution.h"
#include "nn/kernels/copy_channels.h"
#include "nn/kernels/dense.h"
#include "nn/kernels/elementwise.h"
#include "nn/kernels/latitude_sine.h"
#include "nn/kernels/median_log.h"
#include "nn/kernels/normalized_chain.h"
#include "nn/kernels/upsample.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

using Views = std::span<const TensorView>;
using Scratch = std::span<std::byte>;

ConfidenceRule RuleOf(const ConfidencePoolOp& op) {
  return op.rule == ConfidencePoolOp::Rule::kQuarter ? ConfidenceRule::kQuarter
                                                     : ConfidenceRule::kSquareRoot;
}

class RunMaker {
 public:
  RunMaker(const Graph& graph, const FusedNode& fused, int threads)
      : graph_(graph), fused_(fused), threads_(threads) {}

  Step::Run operator()(const ConfidencePoolOp& op) const {
    return [rule = RuleOf(op), threads = threads_](Views in, Views out, Scratch) {
      ConfidencePool(in[0], in[1], out[0], out[1], rule, threads);
    };
  }
  Step::Run operator()(const DenseOp&) const {
    const Weight& weight = this->weight(0);
    const auto kernel = std::make_shared<const Dense>(weight.values, this->weight(1).values,
                                                      weight.shape[0], weight.shape[1]);
    return [kernel](Views in, Views out, Scratch) { kernel->Run(in[0], out[0]); };
  }
  Step::Run operator()(const UpsampleNearestOp&) const { return Simple(UpsampleNearest); }
  Step::Run operator()(const UpsampleBilinearOp& op) const {
    return [padding = op.padding, threads = threads_](Views in, Views out, Scratch) {
      UpsampleBilinear(in[0], out[0], padding, threads);
    };
  }
  Step::Run operator()(const ConvexUpsampleOp& op) const {
    return [op, threads = threads_](Views in, Views out, Scratch) {
      ConvexUpsample(in[0], in[1], out[0], op.factor, op.padding, threads);
    };
  }
  Step::Run operator()(const AveragePoolOp&) const { return Simple(AveragePool); }
  Step::Run operator()(const GlobalAveragePoolOp&) const { return Simple(GlobalAveragePool); }
  Step::Run operator()(const ReluOp&) const { return Simple(Relu); }
  Step::Run operator()(const TanhOp&) const { return Simple(Tanh); }
  Step::Run operator()(const SigmoidOp&) const { return Simple(Sigmoid); }
  Step::Run operator()(const SoftplusOp&) const { return Simple(Softplus); }
  Step::Run operator()(const ExpOp&) const { return Simple(Exp); }
  Step::Run operator()(const LogOp&) const { return Simple(Log); }
  Step::Run operator()(const LeakyReluOp& op) const {
    return [op, threads = threads_](Views in, Views out, Scratch) {
      LeakyRelu(in[0], op.slope, out[0], threads);
    };
  }
  Step::Run operator()(const ClampOp& op) const {
    return [op, threads = threads_](Views in, Views out, Scratch) {
      Clamp(in[0], op.minimum, op.maximum, out[0], threads);
    };
  }
  Step::Run operator()(const AffineOp& op) const {
    return [op, threads = threads_](Views in, Views out, Scratch) {
      Affine(in[0], op.scale, op.offset, out[0], threads);
    };
  }
  Step::Run operator()(const AddOp&) const { return OfTwo(Add); }
  Step::Run operator()(const MultiplyOp&) const { return OfTwo(Multiply); }
  Step::Run operator()(const MedianLogOp&) const {
    return [threads = threads_](Views in, Views out, Scratch) {
      MedianLog(in[0], in[1], out[0], out[1], out[2], threads);
    };
  }
  Step::Run operator()(const LatitudeSineOp&) const {
    return [](Views, Views out, Scratch) { LatitudeSine(out[0]); };
  }
  Step::Run operator()(const ConvolutionOp&) const { return NotHere(); }
  Step::Run operator()(const NormalizedConvolutionOp&) const { return NotHere(); }
  Step::Run operator()(const ConcatenateOp&) const { return NotHere(); }
  Step::Run operator()(const SliceOp&) const { return NotHere(); }

 private:
  const Weight& weight(std::size_t i) const {
    return graph_.weights[static_cast<std::size_t>(fused_.node.weights[i])];
  }
  Step::Run Simple(void (*function)(const TensorView&, const TensorView&, int)) const {
    return [function, threads = threads_](Views in, Views out, Scratch) {
      function(in[0], out[0], threads);
    };
  }
  Step::Run OfTwo(void (*function)(const TensorView&, const TensorView&, const TensorView&,
                                   int)) const {
    return [function, threads = threads_](Views in, Views out, Scratch) {
      function(in[0], in[1], out[0], threads);
    };
  }
  static Step::Run NotHere() {
    ORB360_CHECK(false, "made elsewhere");
    return {};
  }

  const Graph& graph_;
  const FusedNode& fused_;
  int threads_;
};

NormalizedConvolution MakeLink(const Graph& graph, const Node& node) {
  const auto weight = [&](std::size_t i) -> const Weight& {
    return graph.weights[static_cast<std::size_t>(node.weights[i])];
  };
  const std::vector<int>& shape = weight(0).shape;
  return {weight(0).values, weight(1).values,
          shape[0],         shape[1],
          shape[3],         std::get<NormalizedConvolutionOp>(node.operation).padding};
}

Step MakeChain(const Graph& graph, const FusedNode& fused, int width, int threads) {
  std::vector<NormalizedConvolution> links = {MakeLink(graph, fused.node)};
  for (const Node& node : fused.chain) links.push_back(MakeLink(graph, node));
  const auto chain = std::make_shared<const NormalizedChain>(std::move(links));
  std::array<bool, FusedNode::kMaxPairs> doubled{};
  std::ranges::copy(fused.doubled, doubled.begin());
  const std::optional<ConfidenceRule> rule =
      fused.pool ? std::optional(RuleOf(*fused.pool)) : std::nullopt;
  return {[=](Views in, Views out, Scratch scratch) {
            std::array<NormalizedInput, FusedNode::kMaxPairs> inputs;
            const std::size_t pairs = in.size() / 2;
            for (std::size_t i = 0; i < pairs; ++i) {
              inputs[i] = {{in[2 * i], in[2 * i + 1]}, doubled[i]};
            }
            PooledOutput pooled;
            if (rule) pooled = {{out[2], out[3]}, *rule};
            chain->Run({inputs.data(), pairs}, {out[0], out[1]}, scratch, threads,
                       rule ? &pooled : nullptr);
          },
          chain->ScratchBytes(width, threads)};
}

Step MakeConvolution(const Graph& graph, const FusedNode& fused, int height, int width,
                     DataType precision, int threads) {
  const auto weight = [&](std::size_t i) -> const Weight& {
    return graph.weights[static_cast<std::size_t>(fused.node.weights[i])];
  };
  const Tensor& input = graph.tensors[static_cast<std::size_t>(fused.node.inputs[0])];
  const auto kernel = std::make_shared<const Convolution>(
      CpuConvolutionSpec(graph, fused, precision), weight(0).values, weight(1).values);
  return {[kernel, adds = fused.adds_residual, threads](Views in, Views out, Scratch scratch) {
            kernel->Run(in[0], adds ? &in[1] : nullptr, out[0], scratch, threads);
          },
          kernel->ScratchBytes(ShapeFor(input, height, width), threads)};
}

Step MakeStep(const Graph& graph, const FusedNode& fused, int height, int width, DataType precision,
              int threads) {
  if (std::holds_alternative<NormalizedConvolutionOp>(fused.node.operation)) {
    const auto output = static_cast<std::size_t>(fused.node.outputs.front());
    const Shape shape = ShapeFor(graph.tensors[output], height, width);
    return MakeChain(graph, fused, shape.width, threads);
  }
  if (std::holds_alternative<ConvolutionOp>(fused.node.operation)) {
    return MakeConvolution(graph, fused, height, width, precision, threads);
  }
  return {std::visit(RunMaker(graph, fused, threads), fused.node.operation)};
}

Step MakeCopy(const ChannelCopy& copy, int threads) {
  return {[=](Views in, Views out, Scratch) {
    CopyChannels(in[0], copy.from_first, out[0], copy.to_first, copy.count, threads);
  }};
}

}  // namespace

ConvolutionSpec CpuConvolutionSpec(const Graph& graph, const FusedNode& fused, DataType precision) {
  const std::vector<int>& shape =
      graph.weights[static_cast<std::size_t>(fused.node.weights[0])].shape;
  const auto& op = std::get<ConvolutionOp>(fused.node.operation);
  // If a panorama is turned by the smallest step to which the network is equivariant, it must be
  // turned by whole tiles here too, so that the result is turned bit for bit.
  const int halvings =
      graph.tensors[static_cast<std::size_t>(fused.node.outputs[0])].extent.halvings;
  const int step = graph.size_multiple >> std::max(halvings, 0);
  return {.in_channels = shape[1],
          .out_channels = shape[0],
          .kernel = shape[3],
          .stride = op.stride,
          .padding = op.padding,
          .slope = fused.slope,
          .type = ConvolutionType(graph, fused, precision),
          .may_tile = op.padding == Padding::kZero || step % kConvolutionTile == 0,
          .minimum = fused.node.input_range.value_or(InputRange{}).minimum,
          .maximum = fused.node.input_range.value_or(InputRange{}).maximum};
}

CpuBackend::CpuBackend(int threads, DataType precision) : threads_(threads), precision_(precision) {
  if (precision == DataType::kBFloat16 && BestBFloat16Unit() == BFloat16Unit::kNone) {
    throw UserError("this processor has neither AVX-512 BF16 nor AMX; compute with 32 bits");
  }
  if (precision == DataType::kInt8 && FindByteUnit() == ByteUnit::kNone) {
    throw UserError(
        "this processor has neither AVX-512 VNNI nor Arm's dot product; compute with 32 bits");
  }
  ORB360_CHECK(precision != DataType::kFloat16);
}

NodeNeeds CpuBackend::NeedsOf(const Graph& graph, const FusedNode& node) const {
  return CpuNeedsOf(graph, node, precision_);
}

std::unique_ptr<const Program> CpuBackend::MakeProgram(const Graph& graph,
                                                       std::span<const FusedNode> nodes,
                                                       Lowered lowered, int height, int width,
                                                       const ProgramOptions& options) const {
  std::vector<Step> steps = MakeSteps(graph, nodes, lowered, height, width);
  return std::make_unique<CpuProgram>(std::move(lowered), std::move(steps), options, threads_);
}

std::vector<Step> CpuBackend::MakeSteps(const Graph& graph, std::span<const FusedNode> nodes,
                                        const Lowered& lowered, int height, int width) const {
  std::vector<Step> steps(lowered.instructions.size());
  std::exception_ptr failure;  // such as too little memory; it must not leave a parallel loop
#pragma omp parallel for num_threads(threads_) schedule(dynamic)
  for (std::size_t i = 0; i < steps.size(); ++i) {
    try {
      const auto* const copy = std::get_if<ChannelCopy>(&lowered.instructions[i].work);
      steps[i] = copy != nullptr
                     ? MakeCopy(*copy, threads_)
                     : MakeStep(graph, nodes[std::get<std::size_t>(lowered.instructions[i].work)],
                                height, width, precision_, threads_);
    } catch (...) {
#pragma omp critical
      failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  return steps;
}

}  // namespace orb360::nn
