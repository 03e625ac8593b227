#include "tests/nn/vulkan/vulkan_fixture.h"

#include <cstdlib>
#include <utility>

#include <dlfcn.h>

#include "nn/vulkan/choose_device.h"
#include "nn/vulkan/physical_device.h"

namespace orb360::nn {

namespace {

/// Asks the loader of Vulkan itself. Returns why there is no device; empty where there is one,
/// which then has to work.
std::string WhyThereIsNoDevice() {
  void* const library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return "there is no loader of Vulkan";
  const auto function =
      reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = reinterpret_cast<PFN_vkCreateInstance>(
      function(nullptr, "vkCreateInstance"))(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return "there is no driver for Vulkan";
  if (result != VK_SUCCESS) return "";
  std::uint32_t count = 0;
  reinterpret_cast<PFN_vkEnumeratePhysicalDevices>(
      function(instance, "vkEnumeratePhysicalDevices"))(instance, &count, nullptr);
  reinterpret_cast<PFN_vkDestroyInstance>(function(instance, "vkDestroyInstance"))(instance,
                                                                                   nullptr);
  return count == 0 ? "there is no device with Vulkan" : "";
}

}  // namespace

void VulkanTest::SetUp() {
  static const std::string reason = WhyThereIsNoDevice();
  // Where a driver was installed for the tests they do not pass without one.
  if (!reason.empty() && std::getenv("ORB360_TEST_REQUIRES_VULKAN") != nullptr) FAIL() << reason;
  if (!reason.empty()) GTEST_SKIP() << reason;
  // What is thrown here fails the test. As long as this instance exists, drivers and layers stay
  // loaded, so that LeakSanitizer can name them.
  static const auto* const stays = new vulkan::Instance([](const std::string&) {});
  static_cast<void>(stays);
  instance_ = std::make_shared<vulkan::Instance>([this](const std::string& message) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(message);
  });
  VulkanDevices found;
  for (std::size_t i = 0; i < instance_->devices().size(); ++i) {
    found.devices.push_back(vulkan::Describe(*instance_, static_cast<int>(i)));
  }
  const char* const name = std::getenv("ORB360_TEST_DEVICE");
  index_ = ChooseDevice(name != nullptr ? name : "vulkan", found).value();
  device_ = OpenWith(vulkan::LogicalDevice::Replace());
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

Device VulkanTest::OpenWith(std::uint64_t max_buffer_bytes) {
  return {"test",
          std::make_shared<vulkan::VulkanBackend>(std::make_shared<const vulkan::LogicalDevice>(
              instance_, index_, vulkan::LogicalDevice::Replace(), max_buffer_bytes))};
}

Device VulkanTest::OpenWith(const vulkan::VulkanBackendOptions& how) {
  return {"test", std::make_shared<vulkan::VulkanBackend>(
                      std::make_shared<const vulkan::LogicalDevice>(instance_, index_), how)};
}

}  // namespace orb360::nn
