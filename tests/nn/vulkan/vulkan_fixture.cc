#include "tests/nn/vulkan/vulkan_fixture.h"

#include <cstdlib>
#include <utility>

#include "nn/vulkan/choose_device.h"
#include "nn/vulkan/physical_device.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {

void VulkanTest::SetUp() {
  try {
    // As long as it exists, drivers and layers stay loaded, so that LeakSanitizer can name them.
    static const auto* const stays = new vulkan::Instance([](const std::string&) {});
    static_cast<void>(stays);
    instance_ = std::make_shared<vulkan::Instance>(
        [this](const std::string& message) { messages_.push_back(message); });
    VulkanDevices found;
    for (std::size_t i = 0; i < instance_->devices().size(); ++i) {
      found.devices.push_back(vulkan::Describe(*instance_, static_cast<int>(i)));
    }
    const char* const name = std::getenv("ORB360_TEST_DEVICE");
    index_ = ChooseDevice(name != nullptr ? name : "vulkan", found).value();
    device_ = OpenWith(vulkan::LogicalDevice::Replace());
  } catch (const UserError& error) {
    GTEST_SKIP() << error.what();
  }
}

void VulkanTest::TearDown() {
  // Closing the device and the instance tells what was not destroyed.
  device_ = {};
  instance_.reset();
  for (const std::string& message : messages_) ADD_FAILURE() << message;
}

Device VulkanTest::OpenWith(const vulkan::LogicalDevice::Replace& replace) {
  auto device = std::make_shared<const vulkan::LogicalDevice>(instance_, index_, replace);
  std::string name = device->name();
  return {std::move(name), std::make_shared<vulkan::VulkanBackend>(std::move(device))};
}

Device VulkanTest::OpenWith(const vulkan::VulkanBackendOptions& how) {
  return {"test", std::make_shared<vulkan::VulkanBackend>(
                      std::make_shared<const vulkan::LogicalDevice>(instance_, index_), how)};
}

}  // namespace orb360::nn
