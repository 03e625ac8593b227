// Runs a network file whenever it is told to, so that another process can let it and another
// library take turns: first prints a line of JSON about the network, then reads lines, runs once
// for each and answers with the milliseconds that took. Or prints the times of its nodes (--nodes).
#include <cstdio>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmarks/nn/device_peaks.h"
#include "benchmarks/nn/networks/node_times.h"
#include "benchmarks/nn/networks/random_inputs.h"
#include "benchmarks/nn/stopwatch.h"
#include "nn/graph/cpu_backend.h"
#include "nn/graph/layer_cost.h"
#include "nn/kernels/convolution_winograd.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/network_file.h>
#include <orb360/nn/graph/precision.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn {
namespace {

struct Options {
  std::string file;
  int height = 512;
  int threads = 2;
  std::string precision = "float";
  std::string device = "cpu";
  float known = kKnownFraction;
  int nodes = 0;  // runs of which times of nodes are printed
};

std::vector<std::vector<float>> MakeInputs(const Executor& executor, float known) {
  std::vector<std::vector<float>> inputs;
  for (const Executor::Port& port : executor.inputs()) {
    const std::size_t size =
        static_cast<std::size_t>(port.shape.channels) * port.shape.height * port.shape.width;
    inputs.push_back(RandomInput(port.name, size, known));
  }
  return inputs;
}

/// What the convolutions multiply at this size, 10^9 products by type, and the bytes that all nodes
/// read and write: the least time of a network follows from them.
nlohmann::json Work(const Graph& graph, int height, DataType precision) {
  const std::vector<FusedNode> nodes = FuseNodes(graph);
  const std::vector<LayerCost> costs = LayerCosts(graph, nodes, height, 2 * height);
  std::map<std::string, double> products;
  double bytes = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    bytes += static_cast<double>(costs[i].bytes);
    const Node& node = nodes[i].node;
    if (!std::holds_alternative<ConvolutionOp>(node.operation)) continue;
    const ConvolutionSpec spec = CpuConvolutionSpec(graph, nodes[i], precision);
    double count = static_cast<double>(MultiplyAdds(graph, node, height, 2 * height));
    if (spec.is_winograd()) count *= WinogradProducts(spec.stride) / 144.0;
    // Images are multiplied as floats.
    const bool is_float =
        spec.type == DataType::kBFloat16 && spec.in_channels <= kMaxPlanarChannels;
    products[NameOf(is_float ? DataType::kFloat : spec.type)] += 1e-9 * count;
  }
  for (const Node& node : graph.nodes) {  // which are merged in `nodes`
    if (!std::holds_alternative<NormalizedConvolutionOp>(node.operation)) continue;
    products[NameOf(DataType::kFloat)] +=
        1e-9 * static_cast<double>(MultiplyAdds(graph, node, height, 2 * height));
  }
  return {{"products", products}, {"gigabytes", 1e-9 * bytes}};
}

DataType TypeOf(const std::string& precision) {
  if (precision == "bf16") return DataType::kBFloat16;
  return precision == "int8" ? DataType::kInt8 : DataType::kFloat;
}

Peaks PeaksOf(const Device& device, int threads) {
  if (device.backend == nullptr) return MeasurePeaks(threads);
  const DevicePeaks peaks = MeasurePeaks(device);
  return {.fma = peaks.operations, .bandwidth = peaks.bandwidth};
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app("Runs a network once for every line it reads");
  app.add_option("FILE", options.file, "network, as weights_tools writes it")->required();
  app.add_option("--height", options.height, "of the panorama, pixels");
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  app.add_option("--precision", options.precision)
      ->check(CLI::IsMember({"float", "bf16", "int8", "float16"}));
  app.add_option("--device", options.device, "as of orb360; float16 is for GPUs");
  app.add_option("--known", options.known, "fraction of the pixels that have a depth");
  app.add_option("--nodes", options.nodes,
                 "instead of that, print the least time of each node in that many runs")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  std::vector<double> load, pack;
  Graph graph;
  Time([&] { graph = ReadNetwork(options.file); }, &load);
  const Device device = OpenDevice(options.device, options.precision == "float16");
  const ExecutorOptions how{.threads = options.threads,
                            .precision = TypeOf(options.precision),
                            .device = device,
                            .measures_times = options.nodes > 0};
  std::unique_ptr<Executor> executor;
  Time(
      [&] {
        executor = std::make_unique<Executor>(graph, options.height, 2 * options.height, how);
      },
      &pack);
  Executor::Workspace workspace(*executor);
  const std::vector<std::vector<float>> inputs = MakeInputs(*executor, options.known);
  std::vector<std::vector<float>> outputs;
  for (const Executor::Port& port : executor->outputs()) {
    outputs.emplace_back(static_cast<std::size_t>(port.shape.channels) * port.shape.height *
                         port.shape.width);
  }
  const std::vector<std::span<const float>> input_spans(inputs.begin(), inputs.end());
  const std::vector<std::span<float>> output_spans(outputs.begin(), outputs.end());

  const auto run = [&] { executor->Run(input_spans, output_spans, &workspace); };
  if (options.nodes > 0) {
    PrintNodeTimes(graph, *executor, device, options.height, workspace, options.nodes,
                   PeaksOf(device, options.threads), run);
    return 0;
  }

  const nlohmann::json about = {
      {"device", device.name},
      {"work", Work(graph, options.height, how.precision)},
      {"load_ms", load.front()},
      {"pack_ms", pack.front()},
      {"planned_mb", static_cast<double>(executor->planned_bytes()) / 1e6},
      {"naive_mb", static_cast<double>(executor->naive_bytes()) / 1e6}};
  std::cout << about.dump() << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::vector<double> milliseconds;
    Time(run, &milliseconds);
    std::cout << milliseconds.front() << std::endl;
  }
  return 0;
}

}  // namespace
}  // namespace orb360::nn

int main(int argc, char** argv) {
  try {
    return orb360::nn::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nn_network_runner: %s\n", error.what());
    return 1;
  }
}
