#include "nn/vulkan/physical_device.h"

#include <algorithm>
#include <string>
#include <vector>

namespace orb360::nn::vulkan {
namespace {

struct Properties {
  explicit Properties(const Instance& instance, VkPhysicalDevice device) {
    all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    all.pNext = &driver;
    driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
    driver.pNext = &controls;
    controls.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES;
    controls.pNext = &subgroup;
    subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
    instance.functions().GetPhysicalDeviceProperties2(device, &all);
  }
  Properties(const Properties&) = delete;
  Properties& operator=(const Properties&) = delete;

  VkPhysicalDeviceProperties2 all{};
  VkPhysicalDeviceDriverProperties driver{};
  VkPhysicalDeviceFloatControlsProperties controls{};
  VkPhysicalDeviceSubgroupProperties subgroup{};
};

VulkanDevice::Type TypeOf(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return VulkanDevice::Type::kDiscrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return VulkanDevice::Type::kIntegrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return VulkanDevice::Type::kVirtual;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return VulkanDevice::Type::kCpu;
    default:
      return VulkanDevice::Type::kOther;
  }
}

std::string VersionText(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
         std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

std::uint64_t MemoryBytes(const Instance& instance, VkPhysicalDevice device) {
  VkPhysicalDeviceMemoryProperties memory{};
  instance.functions().GetPhysicalDeviceMemoryProperties(device, &memory);
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    const VkMemoryHeap& heap = memory.memoryHeaps[i];
    if ((heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0) {
      bytes = std::max<std::uint64_t>(bytes, heap.size);
    }
  }
  return bytes;
}

bool HasFloat16(const Instance& instance, VkPhysicalDevice device) {
  VkPhysicalDevice16BitStorageFeatures storage{};
  storage.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES;
  VkPhysicalDeviceFeatures2 all{};
  all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  all.pNext = &storage;
  instance.functions().GetPhysicalDeviceFeatures2(device, &all);
  return storage.storageBuffer16BitAccess == VK_TRUE;
}

/// Returns what networks lack on the device; empty if nothing.
std::string ProblemOf(const Instance& instance, VkPhysicalDevice device,
                      const Properties& properties, const VulkanDevice& described) {
  if (properties.all.properties.apiVersion < VK_API_VERSION_1_2) {
    return "it has Vulkan " + described.api_version + ", and 1.2 is needed";
  }
  if (!ComputeQueueFamily(instance, device)) return "it has no queue for computing";
  if (properties.controls.shaderSignedZeroInfNanPreserveFloat32 == VK_FALSE) {
    return "it does not keep NaN and infinity (shaderSignedZeroInfNanPreserveFloat32)";
  }
  return "";
}

std::vector<VkQueueFamilyProperties> QueueFamilies(const Instance& instance,
                                                   VkPhysicalDevice device) {
  std::uint32_t count = 0;
  instance.functions().GetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  instance.functions().GetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

}  // namespace

VulkanDevice Describe(const Instance& instance, int index) {
  VkPhysicalDevice device = instance.devices().at(static_cast<std::size_t>(index));
  const Properties found(instance, device);
  const VkPhysicalDeviceProperties& properties = found.all.properties;
  VulkanDevice described;
  described.index = index;
  described.name = static_cast<const char*>(properties.deviceName);
  described.driver = std::string(static_cast<const char*>(found.driver.driverName)) + " " +
                     static_cast<const char*>(found.driver.driverInfo);
  described.api_version = VersionText(properties.apiVersion);
  described.type = TypeOf(properties.deviceType);
  described.memory_bytes = MemoryBytes(instance, device);
  described.max_buffer_bytes = properties.limits.maxStorageBufferRange;
  described.max_invocations = static_cast<int>(properties.limits.maxComputeWorkGroupInvocations);
  described.shared_bytes = static_cast<int>(properties.limits.maxComputeSharedMemorySize);
  described.subgroup_size = static_cast<int>(found.subgroup.subgroupSize);
  described.has_float16 = HasFloat16(instance, device);
  described.problem = ProblemOf(instance, device, found, described);
  return described;
}

std::optional<std::uint32_t> ComputeQueueFamily(const Instance& instance, VkPhysicalDevice device) {
  const std::vector<VkQueueFamilyProperties> families = QueueFamilies(instance, device);
  std::optional<std::uint32_t> found;
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    const VkQueueFlags flags = families[i].queueFlags;
    if ((flags & VK_QUEUE_COMPUTE_BIT) == 0 || families[i].queueCount == 0) continue;
    if ((flags & VK_QUEUE_GRAPHICS_BIT) == 0) return i;
    if (!found) found = i;
  }
  return found;
}

DeviceClock ClockOf(const Instance& instance, VkPhysicalDevice device, std::uint32_t queue_family) {
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  instance.functions().GetPhysicalDeviceProperties2(device, &properties);
  return {static_cast<double>(properties.properties.limits.timestampPeriod),
          QueueFamilies(instance, device).at(queue_family).timestampValidBits};
}

}  // namespace orb360::nn::vulkan
