#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "benchmarks/nn/contender.h"
#include "benchmarks/nn/onnx_model.h"
#include "benchmarks/nn/onnxruntime_api.h"

namespace orb360::nn {
namespace {

using Handle = OnnxRuntimeApi::Handle;

class OnnxRuntime : public Contender {
 public:
  OnnxRuntime(const Problem& problem, const std::string& library, int threads)
      : api_(library),
        input_(problem.input),
        output_(static_cast<std::size_t>(problem.layer.out_channels) * problem.out_height() *
                problem.out_width()) {
    // The environment is one for the process and lives as long.
    static Handle environment = [&] {
      constexpr int kErrorsOnly = 3;
      Handle created = nullptr;
      api_.Call(kCreateEnv, kErrorsOnly, "orb360", &created);
      return created;
    }();
    Handle options = nullptr;
    api_.Call(kCreateSessionOptions, &options);
    api_.Call(kSetIntraOpNumThreads, options, threads);
    // Its threads must not wait busily while the others' turn is.
    api_.Call(kAddSessionConfigEntry, options, "session.force_spinning_stop", "1");
    const std::filesystem::path profile =
        std::filesystem::temp_directory_path() / ("orb360_ort_" + std::to_string(getpid()));
    api_.Call(kEnableProfiling, options, profile.c_str());
    const std::string model = OnnxModel(problem);
    api_.Call(kCreateSessionFromArray, environment, model.data(), model.size(), options, &session_);
    api_.Release(kReleaseSessionOptions, options);
    const std::array<std::int64_t, 4> in_shape{1, problem.layer.in_channels, problem.height,
                                               problem.width};
    const std::array<std::int64_t, 4> out_shape{1, problem.layer.out_channels, problem.out_height(),
                                                problem.out_width()};
    constexpr int kArena = 1, kDefaultMemory = 0, kFloat = 1;
    Handle info = nullptr;
    api_.Call(kCreateCpuMemoryInfo, kArena, kDefaultMemory, &info);
    const auto wrap = [&](std::vector<float>& values, const std::array<std::int64_t, 4>& shape) {
      Handle value = nullptr;
      api_.Call(kCreateTensorWithDataAsOrtValue, info, values.data(), values.size() * sizeof(float),
                shape.data(), shape.size(), kFloat, &value);
      return value;
    };
    x_ = wrap(input_, in_shape);
    y_ = wrap(output_, out_shape);
    api_.Release(kReleaseMemoryInfo, info);
  }
  OnnxRuntime(const OnnxRuntime&) = delete;
  OnnxRuntime& operator=(const OnnxRuntime&) = delete;
  ~OnnxRuntime() override {
    api_.Release(kReleaseValue, x_);
    api_.Release(kReleaseValue, y_);
    api_.Release(kReleaseSession, session_);
  }

  void Run() override {
    const char* const in_name = "x";
    const char* const out_name = "y";
    Handle no_options = nullptr;
    api_.Call(kRun, session_, no_options, &in_name, &x_, std::size_t{1}, &out_name, std::size_t{1},
              &y_);
  }

  // Its own profile's times of the convolution: a layer inside a network neither reorders its
  // input and output nor pays for a session's run.
  std::vector<double> Milliseconds() override {
    Handle allocator = nullptr;
    api_.Call(kGetAllocatorWithDefaultOptions, &allocator);
    char* path = nullptr;
    api_.Call(kSessionEndProfiling, session_, allocator, &path);
    std::ifstream file(path);
    const nlohmann::json events = nlohmann::json::parse(file);
    std::filesystem::remove(path);
    api_.Call(kAllocatorFree, allocator, static_cast<Handle>(path));
    std::vector<double> milliseconds;
    for (const nlohmann::json& event : events) {
      if (event.value("cat", "") == "Node" && event["args"].value("op_name", "") == "Conv" &&
          event["name"].get<std::string>().ends_with("_kernel_time")) {
        milliseconds.push_back(event["dur"].get<double>() / 1000);
      }
    }
    return milliseconds;
  }
  std::vector<float> Answer() override { return output_; }

 private:
  OnnxRuntimeApi api_;
  std::vector<float> input_;
  std::vector<float> output_;
  Handle session_ = nullptr;
  Handle x_ = nullptr;
  Handle y_ = nullptr;
};

}  // namespace

std::unique_ptr<Contender> MakeOnnxRuntime(const Problem& problem, const std::string& library,
                                           int threads) {
  return std::make_unique<OnnxRuntime>(problem, library, threads);
}

}  // namespace orb360::nn
