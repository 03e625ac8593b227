#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "benchmarks/nn/contender.h"
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// The times of one layer.
struct Result {
  std::string network;
  DataType type;
  Problem problem;  // without its numbers
  std::map<std::string, double> milliseconds;
  double peak = 0;  // GFLOP/s
  // Of the products alone where the convolution is computed in tiles, which has a quarter of them.
  double product_gflops = 0;
  double gflops(const std::string& who) const {
    return 2e-6 * problem.macs() / milliseconds.at(who);
  }
};

/// Over all libraries: what else the machine does makes it larger.
double TotalMilliseconds(const Result& result);

void PrintTable(const std::vector<Result>& results);

/// Of the type of the first result.
nlohmann::json Summarize(const std::vector<Result>& results);

}  // namespace orb360::nn
