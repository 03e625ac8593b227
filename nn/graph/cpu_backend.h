#pragma once

#include "nn/graph/backend.h"

namespace orb360::nn {

/// The kernels of nn/kernels.
class CpuBackend : public Backend {
 public:
  explicit CpuBackend(int threads) : threads_(threads) {}

  NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const override;
  Step MakeStep(const Graph& graph, const FusedNode& node, int height, int width) const override;
  Step MakeCopy(int from_first, int to_first, int count) const override;

 private:
  int threads_;
};

}  // namespace orb360::nn
