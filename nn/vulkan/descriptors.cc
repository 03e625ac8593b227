#include "nn/vulkan/descriptors.h"

#include <cstdint>

namespace orb360::nn::vulkan {

Descriptors Bind(const LogicalDevice& device, VkDescriptorSetLayout layout,
                 const std::array<VkBuffer, 2>& buffers) {
  const char* const action = "bind buffers";
  const DeviceFunctions& functions = device.functions();
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                  static_cast<std::uint32_t>(buffers.size())};
  VkDescriptorPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.maxSets = 1;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  device.Check(functions.CreateDescriptorPool(device.handle(), &info, nullptr, &pool), action);
  Descriptors bound{device.Own(pool, functions.DestroyDescriptorPool)};
  VkDescriptorSetAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  allocation.descriptorPool = pool;
  allocation.descriptorSetCount = 1;
  allocation.pSetLayouts = &layout;
  device.Check(functions.AllocateDescriptorSets(device.handle(), &allocation, &bound.set), action);
  for (std::uint32_t i = 0; i < buffers.size(); ++i) {
    const VkDescriptorBufferInfo buffer{buffers[i], 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = bound.set;
    write.dstBinding = i;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &buffer;
    functions.UpdateDescriptorSets(device.handle(), 1, &write, 0, nullptr);
  }
  return bound;
}

}  // namespace orb360::nn::vulkan
