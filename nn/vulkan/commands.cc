#include "nn/vulkan/commands.h"

namespace orb360::nn::vulkan {
namespace {

constexpr const char* kAction = "record a network";

}  // namespace

Commands::Commands(const LogicalDevice& device) : device_(device) {
  const DeviceFunctions& functions = device.functions();
  VkCommandPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool_info.queueFamilyIndex = device.queue_family();
  VkCommandPool pool = VK_NULL_HANDLE;
  device.Check(functions.CreateCommandPool(device.handle(), &pool_info, nullptr, &pool), kAction);
  pool_ = device.Own(pool, functions.DestroyCommandPool);
  VkCommandBufferAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocation.commandPool = pool;
  allocation.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocation.commandBufferCount = 1;
  device.Check(functions.AllocateCommandBuffers(device.handle(), &allocation, &commands_), kAction);
  VkFenceCreateInfo fence_info{};
  fence_info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  VkFence fence = VK_NULL_HANDLE;
  device.Check(functions.CreateFence(device.handle(), &fence_info, nullptr, &fence), kAction);
  fence_ = device.Own(fence, functions.DestroyFence);
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  device.Check(functions.BeginCommandBuffer(commands_, &begin), kAction);
}

void Commands::CopyBuffer(VkBuffer from, std::size_t from_offset, VkBuffer to,
                          std::size_t to_offset, std::size_t bytes) {
  const VkBufferCopy region{from_offset, to_offset, bytes};
  device_.functions().CmdCopyBuffer(commands_, from, to, 1, &region);
}

void Commands::Barrier() {
  VkMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                          VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  constexpr VkPipelineStageFlags kStages =
      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  device_.functions().CmdPipelineBarrier(commands_, kStages, kStages, 0, 1, &barrier, 0, nullptr, 0,
                                         nullptr);
}

void Commands::Finish() {
  VkMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  device_.functions().CmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                         VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0,
                                         nullptr);
  device_.Check(device_.functions().EndCommandBuffer(commands_), kAction);
}

}  // namespace orb360::nn::vulkan
