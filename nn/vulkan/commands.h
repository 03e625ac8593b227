#pragma once

#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/owned.h"

namespace orb360::nn::vulkan {

/// A list of commands that is recorded once and run any number of times, one run at a time.
class Commands {
 public:
  /// Begins to record.
  explicit Commands(const LogicalDevice& device);

  VkCommandBuffer get() const { return commands_; }
  void CopyBuffer(VkBuffer from, std::size_t from_offset, VkBuffer to, std::size_t to_offset,
                  std::size_t bytes);
  /// What follows sees what was written before, by shaders and copies.
  void Barrier();
  /// Makes what was written visible to the CPU, and ends the list.
  void Finish();
  /// Runs the finished list and waits for its end.
  void RunAndWait() const { device_.RunAndWait(commands_, fence_.get()); }

 private:
  const LogicalDevice& device_;
  Owned<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // of the pool
  Owned<VkFence> fence_;
};

}  // namespace orb360::nn::vulkan
