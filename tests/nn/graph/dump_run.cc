#include "tests/nn/graph/dump_run.h"

#include <cstddef>

#include "tests/nn/tensor_memory.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

Shape SizeOfImage(const Graph& graph, const Dump& inputs) {
  return inputs.at(graph.tensors[static_cast<std::size_t>(graph.inputs.front())].name).shape;
}

}  // namespace

DumpRun::DumpRun(const Graph& graph, const Dump& inputs, const ExecutorOptions& options)
    : executor_(graph, SizeOfImage(graph, inputs).height, SizeOfImage(graph, inputs).width,
                options),
      workspace_(executor_) {
  std::vector<std::span<const float>> from;
  for (const Executor::Port& port : executor_.inputs()) {
    const DumpedTensor& input = inputs.at(port.name);
    ORB360_CHECK(input.shape == port.shape, port.name);
    from.emplace_back(input.values);
  }
  std::vector<std::span<float>> to;
  for (const Executor::Port& port : executor_.outputs()) {
    const auto [channels, height, width] = port.shape;
    DumpedTensor& output = outputs_[port.name];
    output = {port.shape, std::vector<float>(static_cast<std::size_t>(channels * height * width))};
    to.emplace_back(output.values);
  }
  executor_.Run(from, to, &workspace_);
}

DumpedTensor DumpRun::Find(const std::string& tensor) const {
  const TensorView view = executor_.Find(workspace_, tensor);
  DumpedTensor result{view.shape, {}};
  for (int channel = 0; channel < view.shape.channels; ++channel) {
    for (int y = 0; y < view.shape.height; ++y) {
      for (int x = 0; x < view.shape.width; ++x) result.values.push_back(At(view, channel, y, x));
    }
  }
  return result;
}

}  // namespace orb360::nn
