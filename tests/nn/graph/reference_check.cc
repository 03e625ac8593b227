#include "tests/nn/graph/reference_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/nn/graph/dump_run.h"
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

constexpr float kEpsilon = std::numeric_limits<float>::epsilon();

/// The largest finite magnitude: the norm that errors of a tensor are measured by.
float LargestOf(const DumpedTensor& tensor) {
  float largest = 0;
  for (const float value : tensor.values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

/// What errors of a tensor are measured by: its norm and those of what its node reads, from which
/// it may be small by cancellation.
float NormOf(const Graph& graph, const Dump& dump, const std::string& tensor) {
  const auto norm = [&](int index) {
    const auto found = dump.find(graph.tensors[static_cast<std::size_t>(index)].name);
    return found == dump.end() ? 0 : LargestOf(found->second);
  };
  float largest = LargestOf(dump.at(tensor));
  for (const Node& node : graph.nodes) {
    const bool is_writer = std::ranges::any_of(node.outputs, [&](int output) {
      return graph.tensors[static_cast<std::size_t>(output)].name == tensor;
    });
    if (!is_writer) continue;
    for (const int input : node.inputs) largest = std::max(largest, norm(input));
  }
  return largest;
}

}  // namespace

std::filesystem::path ReferenceFile(const std::string& name) {
  return std::filesystem::path(ORB360_SOURCE_DIR) / "tests/nn/data" / (name + ".h5");
}

std::string WorstDifference(const DumpedTensor& result, const DumpedTensor& expected,
                            float tolerance) {
  const auto [channels, height, width] = expected.shape;
  if (result.shape.channels < channels || result.shape.height != height ||
      result.shape.width != width) {
    return "has another shape";
  }
  float worst = tolerance;
  std::string text;
  for (std::size_t i = 0; i < expected.values.size(); ++i) {
    const float a = result.values[i];
    const float b = expected.values[i];
    if (a == b || (std::isnan(a) && std::isnan(b))) continue;
    const float difference = std::abs(a - b);
    if (difference <= worst) continue;
    // NaN where a number should be, or the other way round, is as bad as it gets.
    worst = std::isnan(difference) ? std::numeric_limits<float>::infinity() : difference;
    const int pixel = static_cast<int>(i) % (height * width);
    text = "channel " + std::to_string(static_cast<int>(i) / (height * width));
    text += " row " + std::to_string(pixel / width) + " column " + std::to_string(pixel % width);
    text += ": " + std::to_string(a) + " instead of " + std::to_string(b) + ", tolerance " +
            std::to_string(tolerance);
  }
  return text;
}

void ExpectEveryTensorOf(const std::filesystem::path& path, float roundings,
                         ExecutorOptions options) {
  options.keeps_tensors = true;
  const Graph graph = ReadNetwork(path);
  for (const auto& [name, dump] : ReadDumps(path)) {
    const DumpRun run(graph, dump, options);
    for (const auto& [tensor, expected] : dump) {
      const float tolerance = roundings * kEpsilon * NormOf(graph, dump, tensor);
      EXPECT_EQ(WorstDifference(run.Find(tensor), expected, tolerance), "")
          << path.stem() << " " << name << " " << tensor;
    }
  }
}

void ExpectOutputsOf(const std::filesystem::path& path, float roundings,
                     const ExecutorOptions& options) {
  const Graph graph = ReadNetwork(path);
  for (const auto& [name, dump] : ReadDumps(path)) {
    const DumpRun run(graph, dump, options);
    for (const Graph::Output& output : graph.outputs) {
      const std::string& tensor = graph.tensors[static_cast<std::size_t>(output.tensor)].name;
      const float tolerance = roundings * kEpsilon * NormOf(graph, dump, tensor);
      EXPECT_EQ(WorstDifference(run.outputs().at(output.name), dump.at(tensor), tolerance), "")
          << path.stem() << " " << name << " " << output.name;
    }
  }
}

}  // namespace orb360::nn
