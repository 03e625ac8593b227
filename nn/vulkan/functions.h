#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

namespace orb360::nn::vulkan {

// Vulkan's functions are looked up at run time, so that programs start where there is no Vulkan.

#define ORB360_VULKAN_LOADER_FUNCTIONS(F) F(CreateInstance) F(EnumerateInstanceLayerProperties)

#define ORB360_VULKAN_INSTANCE_FUNCTIONS(F) \
  F(CreateDevice)                           \
  F(DestroyInstance)                        \
  F(EnumeratePhysicalDevices)               \
  F(GetDeviceProcAddr)                      \
  F(GetPhysicalDeviceFeatures2)             \
  F(GetPhysicalDeviceMemoryProperties)      \
  F(GetPhysicalDeviceProperties2)           \
  F(GetPhysicalDeviceQueueFamilyProperties)

#define ORB360_VULKAN_DEVICE_FUNCTIONS(F) \
  F(AllocateCommandBuffers)               \
  F(AllocateDescriptorSets)               \
  F(AllocateMemory)                       \
  F(BeginCommandBuffer)                   \
  F(BindBufferMemory)                     \
  F(CmdBindDescriptorSets)                \
  F(CmdBindPipeline)                      \
  F(CmdCopyBuffer)                        \
  F(CmdDispatch)                          \
  F(CmdPipelineBarrier)                   \
  F(CmdPushConstants)                     \
  F(CmdResetQueryPool)                    \
  F(CmdWriteTimestamp)                    \
  F(CreateBuffer)                         \
  F(CreateCommandPool)                    \
  F(CreateComputePipelines)               \
  F(CreateDescriptorPool)                 \
  F(CreateDescriptorSetLayout)            \
  F(CreateFence)                          \
  F(CreatePipelineLayout)                 \
  F(CreateQueryPool)                      \
  F(CreateShaderModule)                   \
  F(DestroyBuffer)                        \
  F(DestroyCommandPool)                   \
  F(DestroyDescriptorPool)                \
  F(DestroyDescriptorSetLayout)           \
  F(DestroyDevice)                        \
  F(DestroyFence)                         \
  F(DestroyPipeline)                      \
  F(DestroyPipelineLayout)                \
  F(DestroyQueryPool)                     \
  F(DestroyShaderModule)                  \
  F(DeviceWaitIdle)                       \
  F(EndCommandBuffer)                     \
  F(FreeMemory)                           \
  F(GetBufferMemoryRequirements)          \
  F(GetDeviceQueue)                       \
  F(GetQueryPoolResults)                  \
  F(InvalidateMappedMemoryRanges)         \
  F(MapMemory)                            \
  F(QueueSubmit)                          \
  F(ResetFences)                          \
  F(UpdateDescriptorSets)                 \
  F(WaitForFences)

#define ORB360_DECLARE(name) PFN_vk##name name = nullptr;

/// Functions by which instances are made.
struct LoaderFunctions {
  PFN_vkGetInstanceProcAddr GetInstanceProcAddr = nullptr;
  ORB360_VULKAN_LOADER_FUNCTIONS(ORB360_DECLARE)
};
struct InstanceFunctions {
  ORB360_VULKAN_INSTANCE_FUNCTIONS(ORB360_DECLARE)
};
struct DeviceFunctions {
  ORB360_VULKAN_DEVICE_FUNCTIONS(ORB360_DECLARE)
};

#undef ORB360_DECLARE

/// Opens libvulkan.so.1, which stays open until the program ends. Throws UserError where it cannot
/// be opened.
LoaderFunctions LoadVulkan();
InstanceFunctions LoadInstance(const LoaderFunctions& loader, VkInstance instance);
DeviceFunctions LoadDevice(const InstanceFunctions& functions, VkDevice device);

}  // namespace orb360::nn::vulkan
