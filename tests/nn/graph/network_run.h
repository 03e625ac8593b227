#pragma once

#include <vector>

#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/graph/executor.h>

namespace orb360::nn {

/// Inputs and outputs of one run as floats.
struct NetworkRun {
  NetworkRun(const Executor& executor, const std::vector<PlainImage>& images) {
    for (const PlainImage& image : images) {
      inputs.emplace_back(image.values.begin(), image.values.end());
    }
    for (const Executor::Port& output : executor.outputs()) {
      const auto [channels, height, width] = output.shape;
      outputs.emplace_back(static_cast<std::size_t>(channels) * height * width, -1e30f);
    }
  }
  void operator()(const Executor& executor, Executor::Workspace* workspace) {
    const std::vector<std::span<const float>> in(inputs.begin(), inputs.end());
    const std::vector<std::span<float>> out(outputs.begin(), outputs.end());
    executor.Run(in, out, workspace);
  }

  std::vector<std::vector<float>> inputs;
  std::vector<std::vector<float>> outputs;
};

/// The outputs of one run in a workspace of its own.
inline std::vector<std::vector<float>> RunOnce(const Executor& executor,
                                               const std::vector<PlainImage>& inputs) {
  NetworkRun run(executor, inputs);
  Executor::Workspace workspace(executor);
  run(executor, &workspace);
  return run.outputs;
}

}  // namespace orb360::nn
