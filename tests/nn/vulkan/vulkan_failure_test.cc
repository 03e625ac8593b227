// What happens when a driver fails: functions of the driver are replaced by ones that do.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/graph/network_run.h"
#include "tests/nn/graph/random_network.h"
#include "tests/nn/vulkan/vulkan_fixture.h"

namespace orb360::nn {
namespace {

using VulkanFailure = VulkanTest;

VKAPI_ATTR VkResult VKAPI_CALL LoseTheDevice(VkQueue, std::uint32_t, const VkSubmitInfo*, VkFence) {
  return VK_ERROR_DEVICE_LOST;
}

VKAPI_ATTR VkResult VKAPI_CALL HaveNoMemory(VkDevice, const VkMemoryAllocateInfo*,
                                            const VkAllocationCallbacks*, VkDeviceMemory*) {
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

PFN_vkQueueSubmit submit = nullptr;
int submissions_left = 0;

VKAPI_ATTR VkResult VKAPI_CALL SubmitAFewTimes(VkQueue queue, std::uint32_t count,
                                               const VkSubmitInfo* infos, VkFence fence) {
  if (submissions_left-- <= 0) return VK_ERROR_DEVICE_LOST;
  return submit(queue, count, infos, fence);
}

std::string MessageOf(const Graph& graph, const Device& device) {
  try {
    RunOnce(Executor(graph, 8, 16, {.device = device}), RandomInputs(8, 16, 1));
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

TEST_F(VulkanFailure, ALostDeviceIsReportedInOneLine) {
  const Device device =
      OpenWith([](vulkan::DeviceFunctions* f) { f->QueueSubmit = LoseTheDevice; });
  EXPECT_THAT(MessageOf(RandomNetwork(10, 1).Build(), device),
              testing::MatchesRegex("vulkan:[0-9]+ \\(.+\\) could not .+: the device was lost"));
}

TEST_F(VulkanFailure, TooLittleMemoryIsReportedInOneLine) {
  const Device device =
      OpenWith([](vulkan::DeviceFunctions* f) { f->AllocateMemory = HaveNoMemory; });
  EXPECT_THAT(MessageOf(RandomNetwork(10, 1).Build(), device),
              testing::HasSubstr("the device has too little memory"));
}

TEST_F(VulkanFailure, ADeviceMayBeLostInTheMidstOfRuns) {
  const Device device = OpenWith([](vulkan::DeviceFunctions* f) {
    submit = f->QueueSubmit;
    f->QueueSubmit = SubmitAFewTimes;
  });
  submissions_left = 3;  // the weights, and two runs
  const Executor executor(RandomNetwork(10, 1).Build(), 8, 16, {.device = device});
  NetworkRun run(executor, RandomInputs(8, 16, 1));
  Executor::Workspace workspace(executor);
  run(executor, &workspace);
  run(executor, &workspace);
  EXPECT_THROW(run(executor, &workspace), DeviceError);
}

}  // namespace
}  // namespace orb360::nn
