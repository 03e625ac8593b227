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

/// The clock of a device, by which commands write times.
struct DeviceClock {
  double nanoseconds = 0;  ///< Of one tick.
  std::uint32_t bits = 0;  ///< Of a time that count; 0: there is no clock.
};

/// Returns the clock of a queue family.
DeviceClock ClockOf(const Instance& instance, VkPhysicalDevice device, std::uint32_t queue_family);

}  // namespace orb360::nn::vulkan
