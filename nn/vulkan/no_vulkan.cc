// What a build without Vulkan has in the place of devices.cc.

#include "nn/vulkan/choose_device.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn {

VulkanDevices ListVulkanDevices() {
  return {
      {},
      "this program was built without Vulkan; install libvulkan-dev and glslang-tools and build "
      "it again, or use --device cpu"};
}

Device OpenDevice(const std::string& name, bool uses_halves) {
  ChooseDevice(name, ListVulkanDevices());
  ChooseHalves(name, nullptr, uses_halves);
  return {};
}

DevicePeaks MeasurePeaks(const Device& device) {
  ORB360_CHECK(false, device.name);
  return {};
}

}  // namespace orb360::nn
