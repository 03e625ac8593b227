#pragma once

#include <cstdint>
#include <optional>

#include "nn/vulkan/instance.h"
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn::vulkan {

/// Returns what the driver says of device `index` of the instance.
VulkanDevice Describe(const Instance& instance, int index);

/// Returns the queue family for computing: one that does nothing else where there is one, because
/// it runs beside graphics.
std::optional<std::uint32_t> ComputeQueueFamily(const Instance& instance, VkPhysicalDevice device);

}  // namespace orb360::nn::vulkan
