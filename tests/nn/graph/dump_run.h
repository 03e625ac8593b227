#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "tests/nn/dump.h"
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// One run of a network on the inputs that are in a dump, which may hold other tensors as well.
class DumpRun {
 public:
  DumpRun(const Graph& graph, const Dump& inputs, const ExecutorOptions& options = {});

  /// By name of the output.
  const Dump& outputs() const { return outputs_; }

  /// Any tensor of the network by its name in the graph. Only with keeps_tensors.
  DumpedTensor Find(const std::string& tensor) const;

 private:
  Executor executor_;
  Executor::Workspace workspace_;
  Dump outputs_;
};

}  // namespace orb360::nn
