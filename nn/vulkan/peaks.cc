#include "nn/vulkan/peaks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>

#include "nn/vulkan/buffer.h"
#include "nn/vulkan/commands.h"
#include "nn/vulkan/descriptors.h"
#include "nn/vulkan/dispatch.h"
#include "nn/vulkan/pipelines.h"
#include "nn/vulkan/timestamps.h"

namespace orb360::nn::vulkan {
namespace {

constexpr int kRuns = 7;

/// Returns the least time of what is recorded, in milliseconds.
double LeastTime(const LogicalDevice& device, const std::function<void(Commands*)>& record) {
  Timestamps times(device, 2);
  Commands commands(device);
  times.Reset(commands.get());
  times.Write(commands.get());
  record(&commands);
  times.Write(commands.get());
  commands.Finish();
  double least = 0;
  for (int run = 0; run < kRuns; ++run) {
    commands.RunAndWait();
    const double time = times.Intervals().front();
    least = run == 0 ? time : std::min(least, time);
  }
  return least;
}

/// `repetitions`: of each invocation; 64 multiplications with additions each (fma_peak.comp).
double TimeOfProducts(const std::shared_ptr<const LogicalDevice>& device, Pipelines* pipelines,
                      std::uint32_t groups, std::uint32_t group_size, std::uint32_t repetitions) {
  const DeviceFunctions& functions = device->functions();
  const Buffer buffer(*device, sizeof(float), BufferUse::kDevice);
  const Descriptors bound = Bind(*device, pipelines->set_layout(), {buffer.get(), buffer.get()});
  const std::array<std::uint32_t, 4> parameters{0, repetitions, std::bit_cast<std::uint32_t>(0.5F),
                                                std::bit_cast<std::uint32_t>(1.0F)};
  return LeastTime(*device, [&](Commands* commands) {
    VkCommandBuffer list = commands->get();
    functions.CmdBindDescriptorSets(list, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines->layout(), 0, 1,
                                    &bound.set, 0, nullptr);
    functions.CmdBindPipeline(list, VK_PIPELINE_BIND_POINT_COMPUTE,
                              pipelines->Get({Shader::kFmaPeak, {group_size, 1}}));
    functions.CmdPushConstants(list, pipelines->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                               sizeof parameters, parameters.data());
    functions.CmdDispatch(list, groups, 1, 1);
  });
}

double MeasureOperations(const std::shared_ptr<const LogicalDevice>& device) {
  constexpr double kOperations = 2 * 64;
  constexpr double kLongEnough = 2;  // milliseconds
  constexpr std::uint32_t kGroups = 4096;
  constexpr std::uint32_t kMaxRepetitions = 1U << 20;
  const std::uint32_t group_size = std::min<std::uint32_t>(
      256, static_cast<std::uint32_t>(device->description().max_invocations));
  Pipelines pipelines(device);
  // A device that is slow would take long for what a fast one needs to be measured.
  for (std::uint32_t repetitions = 16;; repetitions *= 4) {
    const double time = TimeOfProducts(device, &pipelines, kGroups, group_size, repetitions);
    if (time < kLongEnough && repetitions < kMaxRepetitions) continue;
    return kOperations * kGroups * group_size * repetitions / (1e6 * time);
  }
}

double MeasureBandwidth(const LogicalDevice& device) {
  // More than any cache holds, and little of the memory.
  constexpr std::uint64_t kEnough = std::uint64_t{256} << 20;
  const auto bytes = static_cast<std::size_t>(
      std::min(kEnough, device.description().memory_bytes / 8) / sizeof(float) * sizeof(float));
  const Buffer from(device, bytes, BufferUse::kDevice);
  const Buffer to(device, bytes, BufferUse::kDevice);
  const double time = LeastTime(
      device, [&](Commands* commands) { commands->CopyBuffer(from.get(), 0, to.get(), 0, bytes); });
  return 2.0 * static_cast<double>(bytes) / (1e6 * time);
}

}  // namespace

DevicePeaks MeasurePeaks(const std::shared_ptr<const LogicalDevice>& device) {
  device->RequireClock();
  return {MeasureOperations(device), MeasureBandwidth(*device)};
}

}  // namespace orb360::nn::vulkan
