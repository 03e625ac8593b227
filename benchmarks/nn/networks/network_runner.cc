// Runs a network file whenever it is told to, so that another process can let it and another
// library take turns: first prints a line of JSON about the network, then reads lines, runs once
// for each and answers with the milliseconds that took.
#include <cstdio>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmarks/nn/stopwatch.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

struct Options {
  std::string file;
  int height = 512;
  int threads = 2;
  std::string precision = "float";
  float known = 0.005f;  // fraction of the pixels that have a depth and a confidence
};

std::vector<std::vector<float>> MakeInputs(const Executor& executor, float known) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<std::vector<float>> inputs;
  for (const Executor::Port& port : executor.inputs()) {
    auto& values = inputs.emplace_back(static_cast<std::size_t>(port.shape.channels) *
                                       port.shape.height * port.shape.width);
    const bool is_sparse = port.name == "depth" || port.name == "confidence";
    std::mt19937 points(2);  // depths and confidences in the same places
    for (float& value : values) {
      const bool is_known = !is_sparse || uniform(points) < known;
      value = is_known ? 0.01f + uniform(generator) : 0;
    }
  }
  return inputs;
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app("Runs a network once for every line it reads");
  app.add_option("FILE", options.file, "network, as weights_tools writes it")->required();
  app.add_option("--height", options.height, "of the panorama, pixels");
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  app.add_option("--precision", options.precision)->check(CLI::IsMember({"float", "bf16", "int8"}));
  app.add_option("--known", options.known, "fraction of the pixels that have a depth");
  CLI11_PARSE(app, argc, argv);

  std::vector<double> load, pack;
  Graph graph;
  Time([&] { graph = ReadNetwork(options.file); }, &load);
  const ExecutorOptions how{.threads = options.threads,
                            .precision = options.precision == "bf16"   ? DataType::kBFloat16
                                         : options.precision == "int8" ? DataType::kInt8
                                                                       : DataType::kFloat};
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

  const nlohmann::json about = {
      {"load_ms", load.front()},
      {"pack_ms", pack.front()},
      {"planned_mb", static_cast<double>(executor->planned_bytes()) / 1e6},
      {"naive_mb", static_cast<double>(executor->naive_bytes()) / 1e6}};
  std::cout << about.dump() << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::vector<double> milliseconds;
    Time([&] { executor->Run(input_spans, output_spans, &workspace); }, &milliseconds);
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
