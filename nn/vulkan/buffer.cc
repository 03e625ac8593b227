#include "nn/vulkan/buffer.h"

#include <algorithm>
#include <array>
#include <span>

namespace orb360::nn::vulkan {
namespace {

/// Returns the properties of memory that is good for `use`, best first. The last ones exist on
/// every device.
std::span<const VkMemoryPropertyFlags> WishesFor(BufferUse use) {
  constexpr VkMemoryPropertyFlags kMapped =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  static constexpr std::array<VkMemoryPropertyFlags, 2> kDevice = {
      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
  static constexpr std::array<VkMemoryPropertyFlags, 1> kUpload = {kMapped};
  static constexpr std::array<VkMemoryPropertyFlags, 3> kDownload = {
      kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kMapped};
  if (use == BufferUse::kDevice) return kDevice;
  if (use == BufferUse::kUpload) return kUpload;
  return kDownload;
}

/// Returns the first type of memory of `types` (a bit for each) that has what is wished for.
std::uint32_t ChooseType(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t types,
                         BufferUse use) {
  for (const VkMemoryPropertyFlags wish : WishesFor(use)) {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      const bool is_allowed = (types >> i & 1) != 0;
      if (is_allowed && (memory.memoryTypes[i].propertyFlags & wish) == wish) return i;
    }
  }
  return 0;
}

}  // namespace

Buffer::Buffer(const LogicalDevice& device, std::size_t bytes, BufferUse use) {
  const char* const action = "allocate memory for a network";
  const DeviceFunctions& functions = device.functions();
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = std::max<std::size_t>(bytes, sizeof(float));
  info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (use == BufferUse::kDevice) info.usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  device.Check(functions.CreateBuffer(device.handle(), &info, nullptr, &buffer), action);
  buffer_ = device.Own(buffer, functions.DestroyBuffer);
  VkMemoryRequirements needs{};
  functions.GetBufferMemoryRequirements(device.handle(), buffer, &needs);
  const std::uint32_t type = ChooseType(device.memory(), needs.memoryTypeBits, use);
  // To ask for more than there is would be an error of the caller, of which drivers need not tell.
  const VkPhysicalDeviceMemoryProperties& memories = device.memory();
  const VkDeviceSize heap = memories.memoryHeaps[memories.memoryTypes[type].heapIndex].size;
  device.Check(needs.size <= heap ? VK_SUCCESS : VK_ERROR_OUT_OF_DEVICE_MEMORY, action);
  VkMemoryAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocation.allocationSize = needs.size;
  allocation.memoryTypeIndex = type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  device.Check(functions.AllocateMemory(device.handle(), &allocation, nullptr, &memory), action);
  memory_ = device.Own(memory, functions.FreeMemory);
  device.Check(functions.BindBufferMemory(device.handle(), buffer, memory, 0), action);
  if (use == BufferUse::kDevice) return;
  is_coherent_ =
      (device.memory().memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
  void* data = nullptr;
  device.Check(functions.MapMemory(device.handle(), memory, 0, VK_WHOLE_SIZE, 0, &data), action);
  data_ = static_cast<std::byte*>(data);
}

void Buffer::Invalidate(const LogicalDevice& device) const {
  if (is_coherent_) return;
  VkMappedMemoryRange range{};
  range.sType = VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE;
  range.memory = memory_.get();
  range.size = VK_WHOLE_SIZE;
  device.Check(device.functions().InvalidateMappedMemoryRanges(device.handle(), 1, &range),
               "read a result");
}

}  // namespace orb360::nn::vulkan
