#include "benchmarks/nn/networks/node_times.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "nn/graph/backend.h"
#include "nn/graph/fusion.h"
#include "nn/graph/layer_cost.h"

namespace orb360::nn {
namespace {

struct Work {
  std::string operation = "copy";
  LayerCost cost;
};

/// By the name of the node.
std::map<std::string, Work> WorkOf(const Graph& graph, const Device& device, int height) {
  const std::vector<FusedNode> nodes =
      device.backend != nullptr ? device.backend->Fuse(graph) : FuseNodes(graph);
  const std::vector<LayerCost> costs = LayerCosts(graph, nodes, height, 2 * height);
  std::map<std::string, Work> work;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    work[nodes[i].node.name] = {NameOf(nodes[i].node.operation), costs[i]};
  }
  return work;
}

void PrintRow(const std::string& name, const Work& work, double milliseconds, const Peaks& peaks) {
  const auto per_second = [&](std::int64_t count) {
    return milliseconds > 0 ? 1e-6 * static_cast<double>(count) / milliseconds : 0.0;
  };
  const double speed = per_second(work.cost.operations);
  const double bandwidth = per_second(work.cost.bytes);
  std::printf("| %-28s | %-24s | %8.3f | %8.1f | %3.0f %% | %6.1f | %3.0f %% |\n", name.c_str(),
              work.operation.c_str(), milliseconds, speed, 100 * speed / peaks.fma, bandwidth,
              100 * bandwidth / peaks.bandwidth);
}

}  // namespace

void PrintNodeTimes(const Graph& graph, const Executor& executor, const Device& device, int height,
                    const Executor::Workspace& workspace, int runs, const Peaks& peaks,
                    const std::function<void()>& run) {
  run();  // The first one also touches memory.
  std::vector<Executor::Time> least;
  for (int i = 0; i < runs; ++i) {
    run();
    const std::vector<Executor::Time> times = executor.Times(workspace);
    if (least.empty()) least = times;
    for (std::size_t k = 0; k < times.size(); ++k) {
      least[k].milliseconds = std::min(least[k].milliseconds, times[k].milliseconds);
    }
  }
  std::printf("%s: %.1f GFLOP/s, %.1f GB/s\n", device.name.c_str(), peaks.fma, peaks.bandwidth);
  std::printf("| node | operation | ms | GFLOP/s | of peak | GB/s | of bandwidth |\n");
  std::printf("|---|---|---:|---:|---:|---:|---:|\n");
  const std::map<std::string, Work> work = WorkOf(graph, device, height);
  Work all{"", {}};
  double sum = 0;
  double roofline = 0;
  for (const Executor::Time& time : least) {
    const auto found = work.find(time.name);
    const Work own = found != work.end() ? found->second : Work();
    PrintRow(time.name, own, time.milliseconds, peaks);
    all.cost.operations += own.cost.operations;
    all.cost.bytes += own.cost.bytes;
    sum += time.milliseconds;
    roofline += 1e3 * RooflineSeconds(own.cost, 1e9 * peaks.fma, 1e9 * peaks.bandwidth);
  }
  PrintRow("all", all, sum, peaks);
  std::printf("roofline, node by node: %.3f ms\n", roofline);
}

}  // namespace orb360::nn
