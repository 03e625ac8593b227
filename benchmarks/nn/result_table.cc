#include "benchmarks/nn/result_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>

#include <orb360/nn/graph/precision.h>

namespace orb360::nn {

double TotalMilliseconds(const Result& result) {
  double sum = 0;
  for (const auto& [name, time] : result.milliseconds) sum += time;
  return sum;
}

namespace {

/// Text of a number in a column of that width; blank where there is none.
std::string Column(int width, int decimals, double value, const char* unit = "") {
  if (std::isnan(value)) return std::string(static_cast<std::size_t>(width) + 1, ' ');
  char text[64];
  std::snprintf(text, sizeof text, " %*.*f%s", width - static_cast<int>(std::strlen(unit)),
                decimals, value, unit);
  return text;
}

}  // namespace

void PrintTable(const std::vector<Result>& results) {
  std::printf("%-16s %-13s %-8s %4s %8s %8s %8s %8s %8s %8s %8s %8s %8s\n", "network", "layer",
              "type", "rows", "MMAC", "orb360", "oneDNN", "ORT", "GFLOP/s", "of peak", "products",
              "/oneDNN", "/ORT");
  constexpr int kWidth = 8;
  for (const Result& result : results) {
    const auto time = [&](const char* name) {
      const auto found = result.milliseconds.find(name);
      return found != result.milliseconds.end() ? found->second : std::nan("");
    };
    const double own = time("orb360");
    const double products =
        result.product_gflops > 0 ? 100 * result.product_gflops / result.peak : std::nan("");
    std::string line;
    line += Column(kWidth, 1, result.problem.macs() / 1e6);
    for (const char* name : {"orb360", "oneDNN", "ORT"}) line += Column(kWidth, 3, time(name));
    line += Column(kWidth, 1, result.gflops("orb360"));
    line += Column(kWidth, 1, 100 * result.gflops("orb360") / result.peak, "%");
    line += Column(kWidth, 1, products, "%");
    for (const char* name : {"oneDNN", "ORT"}) line += Column(kWidth, 3, own / time(name));
    std::printf("%-16s %-13s %-8s %4d%s\n", result.network.c_str(),
                result.problem.layer.name.c_str(), NameOf(result.type), result.problem.height,
                line.c_str());
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
