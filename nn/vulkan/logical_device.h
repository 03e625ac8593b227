#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>

#include "nn/vulkan/instance.h"
#include "nn/vulkan/owned.h"
#include "nn/vulkan/physical_device.h"
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn::vulkan {

/// A device that is open for computing. Several threads may use it at once.
class LogicalDevice {
 public:
  /// Changes functions of the driver, for tests of what happens when they fail.
  using Replace = std::function<void(DeviceFunctions*)>;

  /// Throws UserError where networks cannot run on device `index` or it cannot be opened.
  /// `max_buffer_bytes` lowers what the device has, for tests of too large images.
  LogicalDevice(std::shared_ptr<const Instance> instance, int index, const Replace& replace = {},
                std::uint64_t max_buffer_bytes = std::numeric_limits<std::uint64_t>::max());

  const VulkanDevice& description() const { return description_; }
  /// "vulkan:N (NAME)".
  const std::string& name() const { return name_; }
  const DeviceFunctions& functions() const { return functions_; }
  VkDevice handle() const { return device_.get(); }
  std::uint32_t queue_family() const { return queue_family_; }
  const DeviceClock& clock() const { return clock_; }
  /// Throws DeviceError where there is no clock.
  void RequireClock() const;
  const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }

  /// Throws DeviceError unless `result` is success. `action` completes "could not ...".
  void Check(VkResult result, const char* action) const;
  /// Runs the commands and waits for their end.
  void RunAndWait(VkCommandBuffer commands, VkFence fence) const;

  /// Returns an object that owns `handle` and destroys it by `destroy` of functions().
  template <typename Handle, typename Destroy>
  Owned<Handle> Own(Handle handle, Destroy destroy) const {
    return {handle, [device = device_.get(), destroy](Handle it) { destroy(device, it, nullptr); }};
  }

 private:
  std::shared_ptr<const Instance> instance_;
  VulkanDevice description_;
  std::string name_;
  std::uint32_t queue_family_ = 0;
  DeviceClock clock_;
  VkPhysicalDeviceMemoryProperties memory_{};
  Owned<VkDevice> device_;
  DeviceFunctions functions_;
  VkQueue queue_ = VK_NULL_HANDLE;
  mutable std::mutex queue_mutex_;  // Vulkan lets one thread at a time submit.
};

}  // namespace orb360::nn::vulkan
