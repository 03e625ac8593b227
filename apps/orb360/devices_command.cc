#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/orb360/commands.h"
#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/network_file.h>
#include <orb360/nn/models/default_weights.h>
#include <orb360/nn/models/depth_completion.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360 {
namespace {

struct DevicesOptions {
  std::string weights;
  std::vector<int> size = {1024, 512};  // width and height, pixels
  int threads = 0;                      // 0: as many as the machine has
  bool json = false;
};

/// A panorama of a smooth pattern with a point in every 97th pixel, at 1 to 3 units.
struct Example {
  explicit Example(nn::ImageSize size) {
    const auto pixels =
        static_cast<std::size_t>(size.height) * static_cast<std::size_t>(size.width);
    for (std::size_t i = 0; i < pixels; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        rgb.push_back(static_cast<std::uint8_t>((i / 7 + 50 * c) % 256));
      }
      const bool is_point = i % 97 == 0;
      depth.push_back(is_point ? 1 + static_cast<float>(i % 200) / 100 : 0);
      confidence.push_back(is_point ? 1 : 0);
    }
  }

  std::vector<std::uint8_t> rgb;
  std::vector<float> depth;
  std::vector<float> confidence;
};

/// Returns the median time in which the processor completes one panorama, ms, with the copies to
/// and from its memory.
double MeasureMs(const nn::Graph& graph, nn::ImageSize size, const nn::ExecutorOptions& options) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kEnough = std::chrono::seconds(1);
  constexpr std::size_t kMaxRuns = 21;
  const Example example(size);
  const nn::DepthCompletion model(graph, size, options);
  nn::DepthCompletion::Workspace workspace(model);
  const nn::CompletionInput input{example.rgb, example.depth, example.confidence};
  model.Complete(input, &workspace);  // The first run also compiles shaders and touches memory.
  std::vector<double> times;
  const auto start = Clock::now();
  while (times.size() < kMaxRuns && (times.empty() || Clock::now() - start < kEnough)) {
    const auto begin = Clock::now();
    model.Complete(input, &workspace);
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  return Median(times);
}

int ThreadsOf(const DevicesOptions& options) {
  if (options.threads > 0) return options.threads;
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// Returns the time as above, or why there is none.
nlohmann::json Measure(const nn::Graph& graph, const DevicesOptions& options,
                       const std::string& name, bool uses_halves = false) {
  try {
    // As runs do.
    const nn::DataType precision =
        name == "cpu" ? nn::ChoosePrecision(nn::Precision::kAuto, graph) : nn::DataType::kFloat;
    const nn::ExecutorOptions how{.threads = ThreadsOf(options),
                                  .precision = precision,
                                  .device = nn::OpenDevice(name, uses_halves)};
    nlohmann::json measured = {
        {"milliseconds", MeasureMs(graph, {options.size[1], options.size[0]}, how)}};
    if (name == "cpu") measured["precision"] = nn::NameOf(precision);
    return measured;
  } catch (const nn::DeviceError& error) {
    return {{"milliseconds", nullptr}, {"problem", error.what()}};
  } catch (const UserError& error) {
    if (name == "cpu") throw;  // It is the network that cannot be used.
    return {{"milliseconds", nullptr}, {"problem", error.what()}};
  }
}

nlohmann::json Describe(const nn::VulkanDevice& device) {
  return {{"device", "vulkan:" + std::to_string(device.index)},
          {"name", device.name},
          {"type", nn::NameOf(device.type)},
          {"driver", device.driver},
          {"vulkan", device.api_version},
          {"memory_mb", device.memory_bytes >> 20},
          {"max_buffer_mb", device.max_buffer_bytes >> 20},
          {"max_invocations", device.max_invocations},
          {"shared_bytes", device.shared_bytes},
          {"subgroup_size", device.subgroup_size},
          {"float16", device.has_float16},
          {"problem", device.problem},
          {"milliseconds", nullptr},
          {"milliseconds_float16", nullptr},
          {"problem_float16", ""}};
}

std::string TimeText(const nlohmann::json& device) {
  if (device["milliseconds"].is_null()) return device["problem"].get<std::string>();
  char text[32];
  std::snprintf(text, sizeof text, "%.1f ms", device["milliseconds"].get<double>());
  const auto halves = device.find("milliseconds_float16");
  if (halves == device.end()) return text;
  if (halves->is_null()) {
    const auto problem = device["problem_float16"].get<std::string>();
    return problem.empty() ? text : text + (", with --float16: " + problem);
  }
  char more[48];
  std::snprintf(more, sizeof more, ", %.1f ms with --float16", halves->get<double>());
  return std::string(text) + more;
}

void Print(const nlohmann::json& devices) {
  for (const nlohmann::json& device : devices) {
    std::cout << device["device"].get<std::string>();
    if (device.contains("name")) {
      std::cout << "  " << device["name"].get<std::string>() << ", "
                << device["type"].get<std::string>() << ", " << device["driver"].get<std::string>()
                << ", Vulkan " << device["vulkan"].get<std::string>() << ", " << device["memory_mb"]
                << " MiB, buffers of " << device["max_buffer_mb"] << " MiB, subgroups of "
                << device["subgroup_size"] << ", " << (device["float16"].get<bool>() ? "" : "no ")
                << "16-bit floats";
    } else {
      std::cout << "  " << device["threads"] << " threads, "
                << device["precision"].get<std::string>();
    }
    std::cout << ": " << TimeText(device) << '\n';
  }
}

int ListDevices(const DevicesOptions& options) {
  const nn::Graph graph = nn::ReadNetwork(
      options.weights.empty() ? nn::DefaultWeights() : std::filesystem::path(options.weights));
  nlohmann::json cpu = {{"device", "cpu"}, {"threads", ThreadsOf(options)}, {"problem", ""}};
  cpu.update(Measure(graph, options, "cpu"));
  nlohmann::json devices = nlohmann::json::array({cpu});
  const nn::VulkanDevices found = nn::ListVulkanDevices();
  for (const nn::VulkanDevice& device : found.devices) {
    nlohmann::json described = Describe(device);
    if (device.problem.empty()) {
      const auto name = described["device"].get<std::string>();
      described.update(Measure(graph, options, name));
      if (device.has_float16) {
        const nlohmann::json halves = Measure(graph, options, name, true);
        described["milliseconds_float16"] = halves["milliseconds"];
        described["problem_float16"] = halves.value("problem", "");
      }
    }
    devices.push_back(std::move(described));
  }
  if (options.json) {
    std::cout << nlohmann::json{{"devices", devices}, {"problem", found.problem}}.dump(2) << '\n';
    return EXIT_SUCCESS;
  }
  std::cout << "time of one " << options.size[0] << "x" << options.size[1] << " panorama with "
            << graph.name << ":\n";
  Print(devices);
  if (!found.problem.empty()) std::cout << "no other device: " << found.problem << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

void AddDevicesCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand(
      "devices", "List the processors on which networks can run, and measure one on each");
  const auto options = std::make_shared<DevicesOptions>();
  command->add_option("--weights", options->weights,
                      "Network [the one that comes with the program]");
  command->add_option("--size", options->size, "Width and height of the panorama, pixels")
      ->expected(2)
      ->check(CLI::Range(1, 1 << 15))
      ->type_name("W H")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print everything as JSON");
  command->callback([options, chosen] { *chosen = [options] { return ListDevices(*options); }; });
}

}  // namespace orb360
