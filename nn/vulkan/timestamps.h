#pragma once

#include <cstdint>
#include <vector>

#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/owned.h"

namespace orb360::nn::vulkan {

/// Times that a list of commands writes on the device.
class Timestamps {
 public:
  /// `count`: of the times that the list will write. Throws DeviceError where the driver fails.
  /// Contract: the device has a clock.
  Timestamps(const LogicalDevice& device, std::uint32_t count);

  /// Begins the list: forgets the times of the run before.
  void Reset(VkCommandBuffer commands) const;
  /// Writes the time at which all commands before have ended.
  void Write(VkCommandBuffer commands);
  /// Returns the milliseconds between each time and the next one, after a run of the list. Throws
  /// DeviceError where the driver fails.
  std::vector<double> Intervals() const;

 private:
  const LogicalDevice& device_;
  std::uint32_t count_;
  std::uint32_t written_ = 0;
  Owned<VkQueryPool> pool_;
};

}  // namespace orb360::nn::vulkan
