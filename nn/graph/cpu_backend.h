#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "nn/graph/backend.h"
#include "nn/graph/lowering.h"
#include "nn/kernels/convolution.h"

namespace orb360::nn {

/// One kernel with its packed weights, for tensors of the requested formats. It can run on several
/// threads at once and does not allocate.
struct Step {
  using Run =
      std::function<void(std::span<const TensorView> inputs, std::span<const TensorView> outputs,
                         std::span<std::byte> scratch)>;
  Run run;
  /// Bytes of memory, aligned to kAlignment, that one run needs for itself.
  std::size_t scratch_bytes = 0;
};

/// Returns the parameters of a convolution's kernel when `precision` is requested.
ConvolutionSpec CpuConvolutionSpec(const Graph& graph, const FusedNode& fused, DataType precision);

/// The backend that uses the kernels of nn/kernels.
class CpuBackend : public Backend {
 public:
  /// `precision` is the type in which convolutions multiply; they sum in floats, and 8 bits
  /// exactly. Throws UserError for a type that the processor does not support.
  explicit CpuBackend(int threads, DataType precision = DataType::kFloat);

  NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const override;
  std::unique_ptr<const Program> MakeProgram(const Graph& graph, std::span<const FusedNode> nodes,
                                             Lowered lowered, int height, int width,
                                             const ProgramOptions& options) const override;
  /// Returns one step for each instruction.
  std::vector<Step> MakeSteps(const Graph& graph, std::span<const FusedNode> nodes,
                              const Lowered& lowered, int height, int width) const;

 private:
  int threads_;
  DataType precision_;
};

}  // namespace orb360::nn
