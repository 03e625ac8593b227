#include "tests/nn/graph/node_check.h"

#include <gtest/gtest.h>

#include "tests/nn/graph/network_run.h"
#include "tests/nn/reference_interpreter.h"

namespace orb360::nn {
namespace {

PlainImage ToImage(const TensorView& tensor) {
  PlainImage image(tensor.shape);
  for (int c = 0; c < tensor.shape.channels; ++c) {
    for (int y = 0; y < tensor.shape.height; ++y) {
      for (int x = 0; x < tensor.shape.width; ++x) image.at(c, y, x) = At(tensor, c, y, x);
    }
  }
  return image;
}

}  // namespace

void ExpectEveryNodeRight(const Graph& graph, const std::vector<PlainImage>& inputs,
                          ExecutorOptions options) {
  options.keeps_tensors = true;
  const Shape& size = inputs.front().shape;
  const Executor executor(graph, size.height, size.width, options);
  NetworkRun run(executor, inputs);
  Executor::Workspace workspace(executor);
  run(executor, &workspace);
  const auto find = [&](int tensor) {
    return executor.Find(workspace, graph.tensors[static_cast<std::size_t>(tensor)].name);
  };
  for (const Node& node : graph.nodes) {
    std::vector<PlainImage> images;
    for (const int tensor : node.inputs) images.push_back(ToImage(find(tensor)));
    std::vector<const PlainImage*> read;
    for (const PlainImage& image : images) read.push_back(&image);
    NodeResult expected = InterpretNode(graph, node, read);
    for (std::size_t i = 0; i < node.outputs.size(); ++i) {
      PlainImage& tolerance = expected.magnitudes[i];
      // The errors of some hundreds of additions grow like the root of their number; functions like
      // log are exact to the last bits of the largest of their result and 0.1.
      for (double& value : tolerance.values) value = 64 * 0x1p-24 * (value + 0.1);
      SCOPED_TRACE(node.name + " (" + NameOf(node.operation) + ")");
      ExpectNear(find(node.outputs[i]), expected.outputs[i], tolerance);
      if (testing::Test::HasFailure()) return;
    }
  }
}

}  // namespace orb360::nn
