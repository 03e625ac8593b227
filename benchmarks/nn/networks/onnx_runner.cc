// Runs an ONNX model by ONNX Runtime whenever it is told to, as network_runner.cc runs a network
// file.
#include <array>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "benchmarks/nn/networks/random_inputs.h"
#include "benchmarks/nn/onnxruntime_api.h"
#include "benchmarks/nn/stopwatch.h"

namespace orb360::nn {
namespace {

struct Options {
  std::string model;
  std::string library;
  std::vector<std::string> inputs;  // NAME=CHANNELS
  int outputs = 1;
  int height = 512;
  int threads = 2;
};

using Handle = OnnxRuntimeApi::Handle;

Handle OpenModel(const OnnxRuntimeApi& api, const Options& options) {
  constexpr int kErrorsOnly = 3;
  Handle environment = nullptr;
  api.Call(kCreateEnv, kErrorsOnly, "orb360", &environment);
  Handle how = nullptr;
  api.Call(kCreateSessionOptions, &how);
  api.Call(kSetIntraOpNumThreads, how, options.threads);
  // Its threads must not wait busily while the others' turn is.
  api.Call(kAddSessionConfigEntry, how, "session.force_spinning_stop", "1");
  Handle session = nullptr;
  api.Call(kCreateSession, environment, options.model.c_str(), how, &session);
  return session;
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app("Runs an ONNX model once for every line it reads");
  app.add_option("MODEL", options.model, "with outputs named out0, out1, ...")->required();
  app.add_option("--onnxruntime", options.library, "path of libonnxruntime.so")->required();
  app.add_option("--input", options.inputs, "NAME=CHANNELS, in the model's order")->required();
  app.add_option("--outputs", options.outputs, "number of outputs")->check(CLI::PositiveNumber);
  app.add_option("--height", options.height, "of the panorama, pixels");
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  const OnnxRuntimeApi api(options.library);
  const Handle session = OpenModel(api, options);
  constexpr int kArena = 1, kDefaultMemory = 0, kFloat = 1;
  Handle memory = nullptr;
  api.Call(kCreateCpuMemoryInfo, kArena, kDefaultMemory, &memory);
  std::vector<std::string> names;
  std::vector<std::vector<float>> inputs;
  std::vector<Handle> values;
  for (const std::string& text : options.inputs) {
    const std::size_t equals = text.find('=');
    names.push_back(text.substr(0, equals));
    const std::array<std::int64_t, 4> shape{1, std::stoi(text.substr(equals + 1)), options.height,
                                            2 * options.height};
    inputs.push_back(RandomInput(
        names.back(), static_cast<std::size_t>(shape[1] * shape[2] * shape[3]), kKnownFraction));
    Handle value = nullptr;
    api.Call(kCreateTensorWithDataAsOrtValue, memory, inputs.back().data(),
             inputs.back().size() * sizeof(float), shape.data(), shape.size(), kFloat, &value);
    values.push_back(value);
  }
  std::vector<std::string> output_names;
  for (int i = 0; i < options.outputs; ++i) output_names.push_back("out" + std::to_string(i));
  const auto pointers = [](const std::vector<std::string>& texts) {
    std::vector<const char*> list;
    for (const std::string& text : texts) list.push_back(text.c_str());
    return list;
  };
  const std::vector<const char*> in = pointers(names), out = pointers(output_names);
  std::vector<Handle> results(out.size());
  std::cout << "{}" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    for (Handle& result : results) {
      if (result != nullptr) api.Release(kReleaseValue, result);
      result = nullptr;
    }
    std::vector<double> milliseconds;
    Time(
        [&] {
          Handle no_options = nullptr;
          api.Call(kRun, session, no_options, in.data(), values.data(), in.size(), out.data(),
                   out.size(), results.data());
        },
        &milliseconds);
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
    std::fprintf(stderr, "nn_onnx_runner: %s\n", error.what());
    return 1;
  }
}
