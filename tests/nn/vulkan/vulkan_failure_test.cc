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

VKAPI_ATTR VkResult VKAPI_CALL HaveNoQueries(VkDevice, const VkQueryPoolCreateInfo*,
                                             const VkAllocationCallbacks*, VkQueryPool*) {
  return VK_ERROR_OUT_OF_HOST_MEMORY;
}

VKAPI_ATTR VkResult VKAPI_CALL LoseTheTimes(VkDevice, VkQueryPool, std::uint32_t, std::uint32_t,
                                            std::size_t, void*, VkDeviceSize, VkQueryResultFlags) {
  return VK_ERROR_DEVICE_LOST;
}

PFN_vkQueueSubmit submit = nullptr;
int submissions_left = 0;

VKAPI_ATTR VkResult VKAPI_CALL SubmitAFewTimes(VkQueue queue, std::uint32_t count,
                                               const VkSubmitInfo* infos, VkFence fence) {
  if (submissions_left-- <= 0) return VK_ERROR_DEVICE_LOST;
  return submit(queue, count, infos, fence);
}

VkResult result_of_wait = VK_SUCCESS;
VKAPI_ATTR VkResult VKAPI_CALL FailToWait(VkDevice, std::uint32_t, const VkFence*, VkBool32,
                                          std::uint64_t) {
  return result_of_wait;
}

PFN_vkDeviceWaitIdle wait_idle = nullptr;
int waits_until_idle = 0;
VKAPI_ATTR VkResult VKAPI_CALL CountWaitIdle(VkDevice device) {
  ++waits_until_idle;
  return wait_idle(device);
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

TEST_F(VulkanFailure, ADeviceThatCannotMeasureTimesStillRunsNetworks) {
  const Graph graph = RandomNetwork(10, 1).Build();
  const std::vector<PlainImage> inputs = RandomInputs(8, 16, 1);
  const Device device =
      OpenWith([](vulkan::DeviceFunctions* f) { f->CreateQueryPool = HaveNoQueries; });
  EXPECT_EQ(RunOnce(Executor(graph, 8, 16, {.device = device}), inputs),
            RunOnce(Executor(graph, 8, 16, options()), inputs));
  const Executor executor(graph, 8, 16, {.device = device, .measures_times = true});
  EXPECT_THROW(Executor::Workspace{executor}, DeviceError);
}

TEST_F(VulkanFailure, ADeviceMayBeLostBeforeItsTimesAreRead) {
  const Device device =
      OpenWith([](vulkan::DeviceFunctions* f) { f->GetQueryPoolResults = LoseTheTimes; });
  const Executor executor(RandomNetwork(10, 1).Build(), 8, 16,
                          {.device = device, .measures_times = true});
  Executor::Workspace workspace(executor);
  NetworkRun run(executor, RandomInputs(8, 16, 1));
  run(executor, &workspace);
  EXPECT_THROW(executor.Times(workspace), DeviceError);
}

TEST_F(VulkanFailure, ImagesTooLargeForOneBufferAreRefused) {
  const Graph graph = RandomNetwork(10, 1).Build();
  const std::vector<PlainImage> inputs = RandomInputs(256, 512, 1);
  const Executor whole(graph, 256, 512, options());
  const std::uint64_t bytes = whole.planned_bytes();
  EXPECT_EQ(RunOnce(Executor(graph, 256, 512, {.device = OpenWith(bytes)}), inputs),
            RunOnce(whole, inputs));
  try {
    const Executor executor(graph, 256, 512, {.device = OpenWith(bytes - 1)});
    ADD_FAILURE() << "it should be refused";
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.what(), device_.name + " could not prepare a network: it needs " +
                                std::to_string(bytes >> 20) +
                                " MiB in one buffer, and the device has up to " +
                                std::to_string((bytes - 1) >> 20) + " MiB");
  }
}

TEST_F(VulkanFailure, WeightsTooLargeForOneBufferAreRefused) {
  NetworkBuilder net(1);
  net.Input("x", 70);
  net.Convolution("y", "x", 70, 70, 3);
  net.Output("y", "y");
  const Graph graph = net.Build();
  const std::uint64_t weights = sizeof(float) * 70 * 70 * 9;  // a few are added to fill up vectors
  Executor(graph, 1, 1, {.device = OpenWith(2 * weights)});
  EXPECT_THROW(Executor(graph, 1, 1, {.device = OpenWith(weights)}), DeviceError);
}

TEST_F(VulkanFailure, MemoryIsNotFreedWhileTheDeviceWorksInIt) {
  const Device device = OpenWith([](vulkan::DeviceFunctions* f) {
    f->WaitForFences = FailToWait;
    wait_idle = f->DeviceWaitIdle;
    f->DeviceWaitIdle = CountWaitIdle;
  });
  const Graph graph = RandomNetwork(10, 1).Build();
  waits_until_idle = 0;
  result_of_wait = VK_ERROR_OUT_OF_HOST_MEMORY;
  EXPECT_THAT(MessageOf(graph, device), testing::HasSubstr("the driver has too little memory"));
  EXPECT_EQ(waits_until_idle, 1);
}

}  // namespace
}  // namespace orb360::nn
