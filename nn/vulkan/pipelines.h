#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "nn/vulkan/dispatch.h"
#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/owned.h"

namespace orb360::nn::vulkan {

/// The pipelines of a device, each of which is made when it is first needed. All have one layout:
/// two storage buffers (tensors, constants) and kParameterBytes of push constants. Several threads
/// may use it at once.
class Pipelines {
 public:
  /// What every device accepts.
  static constexpr int kParameterBytes = 128;

  explicit Pipelines(std::shared_ptr<const LogicalDevice> device);

  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  VkPipelineLayout layout() const { return layout_.get(); }
  /// Throws DeviceError where the driver fails.
  VkPipeline Get(const PipelineKey& key);

 private:
  Owned<VkPipeline> Make(const PipelineKey& key) const;

  std::shared_ptr<const LogicalDevice> device_;
  Owned<VkDescriptorSetLayout> set_layout_;
  Owned<VkPipelineLayout> layout_;
  std::mutex mutex_;
  std::map<PipelineKey, Owned<VkPipeline>> made_;
};

}  // namespace orb360::nn::vulkan
