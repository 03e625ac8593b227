#include "nn/vulkan/logical_device.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

std::string Reason(VkResult result) {
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      return "the device was lost";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "the device has too little memory";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "the driver has too little memory";
    default:
      return "the driver reported error " + std::to_string(result);
  }
}

}  // namespace

LogicalDevice::LogicalDevice(std::shared_ptr<const Instance> instance, int index,
                             const Replace& replace, std::uint64_t max_buffer_bytes)
    : instance_(std::move(instance)),
      description_(Describe(*instance_, index)),
      name_("vulkan:" + std::to_string(index) + " (" + description_.name + ")") {
  description_.max_buffer_bytes = std::min(description_.max_buffer_bytes, max_buffer_bytes);
  if (!description_.problem.empty()) {
    throw UserError(name_ + " cannot run networks: " + description_.problem);
  }
  VkPhysicalDevice physical = instance_->devices()[static_cast<std::size_t>(index)];
  queue_family_ = ComputeQueueFamily(*instance_, physical).value();
  clock_ = ClockOf(*instance_, physical, queue_family_);
  instance_->functions().GetPhysicalDeviceMemoryProperties(physical, &memory_);
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDevice16BitStorageFeatures storage{};
  storage.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES;
  storage.storageBuffer16BitAccess = description_.has_float16 ? VK_TRUE : VK_FALSE;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &storage;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  VkDevice device = VK_NULL_HANDLE;
  const VkResult result = instance_->functions().CreateDevice(physical, &info, nullptr, &device);
  if (result != VK_SUCCESS) throw UserError(name_ + " cannot be opened: " + Reason(result));
  // Before the other functions, of which one may be missing.
  const auto destroy = reinterpret_cast<PFN_vkDestroyDevice>(
      instance_->functions().GetDeviceProcAddr(device, "vkDestroyDevice"));
  device_ = {device, [destroy](VkDevice it) {
               if (destroy != nullptr) destroy(it, nullptr);
             }};
  functions_ = LoadDevice(instance_->functions(), device);
  functions_.GetDeviceQueue(device, queue_family_, 0, &queue_);
  if (replace) replace(&functions_);
}

void LogicalDevice::Check(VkResult result, const char* action) const {
  if (result == VK_SUCCESS) return;
  throw DeviceError(name_ + " could not " + action + ": " + Reason(result));
}

void LogicalDevice::RequireClock() const {
  if (clock_.bits > 0) return;
  throw DeviceError(name_ + " could not measure times: it has no clock");
}

void LogicalDevice::RunAndWait(VkCommandBuffer commands, VkFence fence) const {
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  Check(functions_.ResetFences(handle(), 1, &fence), "run a network");
  {
    const std::lock_guard lock(queue_mutex_);
    Check(functions_.QueueSubmit(queue_, 1, &submit, fence), "run a network");
  }
  // A driver that hangs is reset by the system, and the device is lost then.
  constexpr auto kForever = std::numeric_limits<std::uint64_t>::max();
  const VkResult result = functions_.WaitForFences(handle(), 1, &fence, VK_TRUE, kForever);
  if (result != VK_SUCCESS && result != VK_ERROR_DEVICE_LOST) {
    // The device may still work in memory that the caller frees because of the error.
    const std::lock_guard lock(queue_mutex_);
    functions_.DeviceWaitIdle(handle());
  }
  Check(result, "run a network");
}

}  // namespace orb360::nn::vulkan
