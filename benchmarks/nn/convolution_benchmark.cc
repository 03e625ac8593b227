// Times every layer of the networks beside oneDNN and ONNX Runtime: runs take turns, so that what
// else the machine does meets all of them, answers are compared, and times are medians.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <random>
#include <thread>

#include <CLI/CLI.hpp>
#include <dnnl.hpp>
#include <hwy/highway.h>
#include <nlohmann/json.hpp>

#include "benchmarks/nn/contender.h"
#include "benchmarks/nn/device_peaks.h"
#include "benchmarks/nn/fma_peak.h"
#include "benchmarks/nn/layers.h"
#include "benchmarks/nn/result_table.h"
#include "benchmarks/nn/stopwatch.h"
#include "nn/kernels/convolution.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/precision.h>

namespace orb360::nn {
namespace {

struct Options {
  std::vector<std::string> networks = {"completion"};
  std::vector<int> heights = {512, 1024};  // of the panorama
  std::string layer;                       // only layers whose name has this in it
  std::vector<std::string> types = {"float"};
  std::string onnxruntime;
  int threads = 2;
  int runs = 20;
  double seconds = 0.5;  // for a layer and round, if more than `runs` fit
  int rounds = 2;
  bool best = false;  // minima instead of medians
  bool avx2 = false;
  bool peaks = false;
  bool json = false;
};

std::vector<float> Random(std::size_t count, float scale, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-scale, scale);
  std::vector<float> values(count);
  for (float& value : values) value = uniform(generator);
  return values;
}

Problem MakeProblem(const Layer& layer, int panorama_height) {
  const int taps = layer.in_channels * layer.kernel * layer.kernel;
  const int height = panorama_height / layer.reduction;
  return {layer, height, 2 * height,
          // Outputs as large as inputs, as in a network.
          Random(static_cast<std::size_t>(layer.out_channels) * taps,
                 std::sqrt(3.0f / static_cast<float>(taps)), 1),
          Random(layer.out_channels, 1, 2),
          Random(static_cast<std::size_t>(layer.in_channels) * height * 2 * height, 1, 3)};
}

double Typical(std::vector<double> values, bool best) {
  ORB360_CHECK(!values.empty());
  std::sort(values.begin(), values.end());
  return best ? values.front() : values[values.size() / 2];
}

// The largest difference over the root of the mean square of `right`.
double Difference(const std::vector<float>& left, const std::vector<float>& right) {
  ORB360_CHECK(left.size() == right.size(), left.size(), right.size());
  double worst = 0, square = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    worst = std::max(worst, std::abs(double{left[i]} - right[i]));
    square += double{right[i]} * right[i];
  }
  return worst / std::sqrt(square / static_cast<double>(left.size()));
}

// 10^9 operations per second of all threads, with the instruction that multiplies that type.
double MeasurePeak(DataType type, int threads) {
  if (type == DataType::kBFloat16) return MeasureBFloat16Peak(threads);
  return type == DataType::kInt8 ? MeasureBytePeak(threads) : MeasureFmaPeak(threads);
}

Result Measure(const std::string& network, const Layer& layer, int panorama_height, DataType type,
               const Options& options) {
  Problem problem = MakeProblem(layer, panorama_height);
  std::map<std::string, std::unique_ptr<Contender>> contenders;
  std::unique_ptr<Contender> made = MakeOrb360(problem, type, options.threads);
  Contender* const own = made.get();
  const bool is_in_tiles = own->RunProducts() > 0;
  contenders["orb360"] = std::move(made);
  contenders["oneDNN"] = MakeOneDnn(problem, type, options.threads);
  if (!options.onnxruntime.empty() && type == DataType::kFloat) {
    contenders["ORT"] = MakeOnnxRuntime(problem, options.onnxruntime, options.threads);
  }
  std::erase_if(contenders, [](const auto& entry) { return entry.second == nullptr; });
  for (const auto& [name, contender] : contenders) contender->Run();  // answers, and warms up
  const std::vector<float> answer = contenders["orb360"]->Answer();
  for (const auto& [name, contender] : contenders) {
    // Sums of a few thousand terms in another order; short types have 8 bits.
    const double tolerance =
        type == DataType::kFloat ? 1e-4 : (type == DataType::kInt8 ? 0.1 : 3e-2);
    const double difference = Difference(answer, contender->Answer());
    if (!(difference < tolerance)) {
      throw std::runtime_error(layer.name + ": " + name + " gives another answer, by " +
                               std::to_string(difference));
    }
  }
  std::vector<double> peaks, product_times;
  double products = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto is_over = [&] {
    return std::chrono::steady_clock::now() - start >
           std::chrono::duration<double>(options.seconds);
  };
  for (int run = 0; run < options.runs || !is_over(); ++run) {
    peaks.push_back(1 / MeasurePeak(type, options.threads));
    if (is_in_tiles) {
      Time([&] { products = own->RunProducts(); }, &product_times);
    }
    for (const auto& [name, contender] : contenders) {
      // OpenMP's threads wait busily for a while after their work; another library's turn must
      // begin after that (scripts/bench makes the while short).
      if (name == "ORT") std::this_thread::sleep_for(std::chrono::milliseconds(1));
      contender->Run();
    }
  }
  Result result{network, type, std::move(problem), {}, 1 / Typical(peaks, options.best)};
  if (is_in_tiles) {
    result.product_gflops = 2e-6 * products / Typical(std::move(product_times), options.best);
  }
  result.problem.weight = result.problem.bias = result.problem.input = {};
  for (const auto& [name, contender] : contenders) {
    // The first run was to warm up.
    std::vector<double> times = contender->Milliseconds();
    times.erase(times.begin());
    result.milliseconds[name] = Typical(std::move(times), options.best);
  }
  return result;
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app("Convolutions of the networks' layers beside oneDNN and ONNX Runtime");
  app.add_option("--network", options.networks, "completion, encoder-decoder, multi-stream");
  app.add_option("--height", options.heights, "heights of the panorama in pixels");
  app.add_option("--layer", options.layer, "only layers with this in their name");
  app.add_option("--type", options.types,
                 "float, bf16, int8; what the processor has not is left out")
      ->check(CLI::IsMember({"float", "bf16", "int8"}));
  app.add_flag("--peaks", options.peaks, "print only what the processor can do at most, as JSON");
  app.add_option("--onnxruntime", options.onnxruntime, "path of libonnxruntime.so");
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  app.add_option("--runs", options.runs, "at least")->check(CLI::PositiveNumber);
  app.add_option("--seconds", options.seconds, "for a layer and round, at least");
  app.add_option("--rounds", options.rounds,
                 "over all layers; of each layer the one that was quieter for all libraries counts")
      ->check(CLI::PositiveNumber);
  app.add_flag("--best", options.best, "minima instead of medians, for a busy machine");
  app.add_flag("--avx2", options.avx2, "without AVX-512; oneDNN too, but not ONNX Runtime");
  app.add_flag("--json", options.json, "print only the summary, as JSON");
  CLI11_PARSE(app, argc, argv);
  if (options.avx2) {
    hwy::DisableTargets(HWY_AVX2 - 1);  // a better set of instructions has a lower bit
    dnnl::set_max_cpu_isa(dnnl::cpu_isa::avx2);
  }
  if (options.peaks) {
    const Peaks peaks = MeasurePeaks(options.threads);
    const nlohmann::json json = {{"float", peaks.fma},
                                 {"bfloat16", peaks.bfloat16},
                                 {"int8", peaks.bytes},
                                 {"bandwidth", peaks.bandwidth}};
    std::cout << json.dump() << '\n';
    return 0;
  }
  const MatrixUnits units = FindMatrixUnits();
  std::vector<DataType> types;
  for (const std::string& name : options.types) {
    if (name == "float") types.push_back(DataType::kFloat);
    if (name == "bf16" && units.avx512_bfloat16) types.push_back(DataType::kBFloat16);
    if (name == "int8" && (units.avx512_vnni || units.arm_dot_product))
      types.push_back(DataType::kInt8);
  }
  std::vector<Result> results;
  for (int round = 0; round < options.rounds; ++round) {
    std::size_t next = 0;
    const auto measure = [&](const LayerList& list, const Layer& layer, int height, DataType type) {
      if (layer.name.find(options.layer) == std::string::npos) return;
      // Images are multiplied as floats.
      if (type == DataType::kInt8 && layer.in_channels <= kMaxPlanarChannels) return;
      Result result = Measure(list.network, layer, height, type, options);
      if (next == results.size()) {
        results.push_back(std::move(result));
      } else if (TotalMilliseconds(result) < TotalMilliseconds(results[next])) {
        results[next] = std::move(result);
      }
      ++next;
      if (!options.json) std::cerr << '.' << std::flush;
    };
    for (const LayerList& list : {kCompletionLayers, kEncoderDecoderLayers, kMultiStreamLayers}) {
      if (std::count(options.networks.begin(), options.networks.end(), list.network) == 0) continue;
      for (const int height : options.heights) {
        for (const Layer& layer : list.layers) {
          for (const DataType type : types) measure(list, layer, height, type);
        }
      }
    }
  }
  if (results.empty()) throw std::runtime_error("no such layer");
  if (!options.json) {
    std::cerr << '\n';
    PrintTable(results);
  }
  std::cout << Summarize(results).dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace orb360::nn

int main(int argc, char** argv) {
  try {
    return orb360::nn::Main(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
