#include <memory>
#include <string>
#include <utility>

#include "nn/vulkan/choose_device.h"
#include "nn/vulkan/instance.h"
#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/peaks.h"
#include "nn/vulkan/physical_device.h"
#include "nn/vulkan/vulkan_backend.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn {
namespace {

VulkanDevices DevicesOf(const vulkan::Instance& instance) {
  VulkanDevices found;
  for (std::size_t i = 0; i < instance.devices().size(); ++i) {
    found.devices.push_back(vulkan::Describe(instance, static_cast<int>(i)));
  }
  if (found.devices.empty()) {
    found.problem =
        "there is no Vulkan device on this machine; install the driver of the graphics card, or "
        "use --device cpu";
  }
  return found;
}

Device Open(std::shared_ptr<const vulkan::Instance> instance, int index, bool stores_halves) {
  auto device = std::make_shared<const vulkan::LogicalDevice>(std::move(instance), index);
  const std::string name = device->name() + (stores_halves ? " with 16-bit storage" : "");
  const vulkan::VulkanBackendOptions options{.uses_halves = stores_halves};
  return {name, std::make_shared<vulkan::VulkanBackend>(std::move(device), options)};
}

}  // namespace

VulkanDevices ListVulkanDevices() {
  try {
    return DevicesOf(vulkan::Instance());
  } catch (const UserError& error) {
    return {{}, error.what()};
  }
}

Device OpenDevice(const std::string& name, bool uses_halves) {
  CheckDeviceName(name);
  std::shared_ptr<const vulkan::Instance> instance;
  VulkanDevices found;
  if (name != "cpu") {
    try {
      instance = std::make_shared<vulkan::Instance>();
      found = DevicesOf(*instance);
    } catch (const UserError& error) {
      found.problem = error.what();
    }
  }
  return OpenChosen(name, std::move(found), uses_halves, [&](int index, bool stores_halves) {
    return Open(instance, index, stores_halves);
  });
}

DevicePeaks MeasurePeaks(const Device& device) {
  const auto* const backend = dynamic_cast<const vulkan::VulkanBackend*>(device.backend.get());
  ORB360_CHECK(backend != nullptr, device.name);
  return vulkan::MeasurePeaks(backend->device());
}

}  // namespace orb360::nn
