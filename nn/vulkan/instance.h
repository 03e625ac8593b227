#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "nn/vulkan/functions.h"
#include "nn/vulkan/owned.h"

namespace orb360::nn::vulkan {

/// Receives the messages of the validation layer.
using OnMessage = std::function<void(const std::string&)>;

/// Vulkan in this process.
class Instance {
 public:
  /// With `on_message`, the validation layer checks all calls, shaders and barriers. Throws
  /// UserError where there is no Vulkan or, with `on_message`, no such layer.
  explicit Instance(OnMessage on_message = {});

  const InstanceFunctions& functions() const { return functions_; }
  /// Devices in the order of the drivers.
  const std::vector<VkPhysicalDevice>& devices() const { return devices_; }

 private:
  std::unique_ptr<OnMessage> on_message_;  // at a fixed address, which the messenger has
  Owned<VkInstance> instance_;
  Owned<VkDebugUtilsMessengerEXT> messenger_;
  InstanceFunctions functions_;
  std::vector<VkPhysicalDevice> devices_;
};

}  // namespace orb360::nn::vulkan
