#pragma once

#include <array>

#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/owned.h"

namespace orb360::nn::vulkan {

/// A set that binds two buffers to the shaders.
struct Descriptors {
  Owned<VkDescriptorPool> pool;
  VkDescriptorSet set = VK_NULL_HANDLE;  // of the pool
};

/// Binds the buffers of tensors and of constants (Pipelines). Throws DeviceError where the driver
/// fails.
Descriptors Bind(const LogicalDevice& device, VkDescriptorSetLayout layout,
                 const std::array<VkBuffer, 2>& buffers);

}  // namespace orb360::nn::vulkan
