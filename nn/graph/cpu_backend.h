#pragma once

#include "nn/graph/backend.h"

namespace orb360::nn {

/// The backend that uses the kernels of nn/kernels.
class CpuBackend : public Backend {
 public:
  /// `precision` is the type in which convolutions multiply; they always sum in floats. Throws
  /// UserError for kBFloat16 if the processor does not support it.
  explicit CpuBackend(int threads, DataType precision = DataType::kFloat);

  NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const override;
  std::vector<Step> MakeSteps(const Graph& graph, std::span<const FusedNode> nodes, int height,
                              int width) const override;
  Step MakeCopy(int from_first, int to_first, int count) const override;

 private:
  int threads_;
  DataType precision_;
};

}  // namespace orb360::nn
