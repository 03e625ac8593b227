#include "benchmarks/nn/result_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <orb360/nn/graph/precision.h>

namespace orb360::nn {

double TotalMilliseconds(const Result& result) {
  double sum = 0;
  for (const auto& [name, time] : result.milliseconds) sum += time;
  return sum;
}

void PrintTable(const std::vector<Result>& results) {
  std::printf("%-16s %-13s %-8s %4s %7s %8s %8s %8s %8s %7s %9s %8s %8s\n", "network", "layer",
              "type", "rows", "MMAC", "orb360", "oneDNN", "ORT", "GFLOP/s", "of peak", "products",
              "/oneDNN", "/ORT");
  for (const Result& result : results) {
    const auto& times = result.milliseconds;
    const auto column = [&](const char* name, double scale) {
      return times.contains(name) ? times.at(name) * scale : std::nan("");
    };
    const double own = times.at("orb360");
    std::printf(
        "%-16s %-13s %-8s %4d %7.1f %8.3f %8.3f %8.3f %8.1f %6.1f%% %8.1f%% %8.3f %8.3f\n",
        result.network.c_str(), result.problem.layer.name.c_str(), NameOf(result.type),
        result.problem.height, result.problem.macs() / 1e6, own, column("oneDNN", 1),
        column("ORT", 1), result.gflops("orb360"), 100 * result.gflops("orb360") / result.peak,
        100 * (result.product_gflops > 0 ? result.product_gflops / result.peak : std::nan("")),
        own / column("oneDNN", 1), own / column("ORT", 1));
  }
}

nlohmann::json Summarize(const std::vector<Result>& results) {
  std::map<std::string, double> log_ratio;
  std::map<std::string, int> count;
  double worst = 0, lowest = 1, lowest_of_products = 1;
  for (const Result& result : results) {
    if (result.type != results.front().type) continue;  // of the type named first
    const double own = result.milliseconds.at("orb360");
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [name, time] : result.milliseconds) {
      if (name == "orb360") continue;
      log_ratio[name] += std::log(own / time);
      ++count[name];
      best = std::min(best, time);
    }
    constexpr double kWorthComparing = 20e6;  // MACs: below, the start of the threads is measured
    if (result.problem.macs() >= kWorthComparing) worst = std::max(worst, own / best);
    const Layer& layer = result.problem.layer;
    if (layer.kernel == 3 && std::min(layer.in_channels, layer.out_channels) >= 32) {
      const bool is_in_tiles = result.product_gflops > 0;
      const double gflops = is_in_tiles ? result.product_gflops : result.gflops("orb360");
      (is_in_tiles ? lowest_of_products : lowest) =
          std::min(is_in_tiles ? lowest_of_products : lowest, gflops / result.peak);
    }
  }
  nlohmann::json summary;
  if (count["oneDNN"] > 0) {
    summary["conv_vs_onednn_geomean"] = std::exp(log_ratio["oneDNN"] / count["oneDNN"]);
  }
  if (count["ORT"] > 0) summary["conv_vs_ort_geomean"] = std::exp(log_ratio["ORT"] / count["ORT"]);
  summary["conv_vs_best_worst_layer"] = worst;
  summary["peak_fraction"] = lowest;                      // of direct kernels
  summary["product_peak_fraction"] = lowest_of_products;  // of tiles
  return summary;
}

}  // namespace orb360::nn
