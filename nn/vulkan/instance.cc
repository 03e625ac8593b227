#include "nn/vulkan/instance.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL Receive(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                       VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data,
                                       void* on_message) {
  (*static_cast<const OnMessage*>(on_message))(data->pMessage);
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT DescribeMessenger(OnMessage* on_message) {
  VkDebugUtilsMessengerCreateInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                         VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  info.pfnUserCallback = Receive;
  info.pUserData = on_message;
  return info;
}

void RequireValidationLayer(const LoaderFunctions& loader) {
  std::uint32_t count = 0;
  loader.EnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  loader.EnumerateInstanceLayerProperties(&count, layers.data());
  const bool is_there = std::ranges::any_of(layers, [](const VkLayerProperties& layer) {
    return std::string_view(layer.layerName) == kValidationLayer;
  });
  if (is_there) return;
  throw UserError("the validation layer of Vulkan is missing; install vulkan-validationlayers");
}

}  // namespace

Instance::Instance(OnMessage on_message) {
  const LoaderFunctions loader = LoadVulkan();
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "orb360";
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  constexpr std::array kExtensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                      VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  const VkValidationFeatureEnableEXT barriers =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{};
  if (on_message) {
    RequireValidationLayer(loader);
    on_message_ = std::make_unique<OnMessage>(std::move(on_message));
    messenger = DescribeMessenger(on_message_.get());
    features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &barriers;
    messenger.pNext = &features;
    info.pNext = &messenger;  // for messages about the instance itself
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = kExtensions.size();
    info.ppEnabledExtensionNames = kExtensions.data();
  }
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = loader.CreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
    throw UserError(
        "there is no Vulkan driver on this machine; install the driver of the graphics card, or "
        "use --device cpu");
  }
  if (result != VK_SUCCESS) {
    throw UserError("Vulkan cannot be started (vkCreateInstance gave " + std::to_string(result) +
                    "); install the driver of the graphics card again, or use --device cpu");
  }
  // Before the other functions, of which one may be missing.
  const auto destroy = reinterpret_cast<PFN_vkDestroyInstance>(
      loader.GetInstanceProcAddr(instance, "vkDestroyInstance"));
  instance_ = {instance, [destroy](VkInstance handle) {
                 if (destroy != nullptr) destroy(handle, nullptr);
               }};
  functions_ = LoadInstance(loader, instance);
  if (on_message_) {
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        loader.GetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
    const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        loader.GetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
    messenger.pNext = nullptr;
    VkDebugUtilsMessengerEXT handle = VK_NULL_HANDLE;
    ORB360_CHECK(create(instance, &messenger, nullptr, &handle) == VK_SUCCESS);
    messenger_ = {handle, [instance, destroy_messenger](VkDebugUtilsMessengerEXT it) {
                    destroy_messenger(instance, it, nullptr);
                  }};
  }
  std::uint32_t count = 0;
  VkResult listed = functions_.EnumeratePhysicalDevices(instance, &count, nullptr);
  devices_.resize(count);
  if (listed == VK_SUCCESS && count > 0) {
    // VK_INCOMPLETE: a device was added meanwhile.
    listed = functions_.EnumeratePhysicalDevices(instance, &count, devices_.data());
  }
  devices_.resize(count);
  if (listed != VK_SUCCESS && listed != VK_INCOMPLETE) {
    throw UserError("Vulkan cannot list its devices (vkEnumeratePhysicalDevices gave " +
                    std::to_string(listed) +
                    "); install the driver of the graphics card again, or use --device cpu");
  }
}

}  // namespace orb360::nn::vulkan
