#pragma once

#include <cstddef>
#include <cstdint>

#include "nn/vulkan/logical_device.h"
#include "nn/vulkan/owned.h"

namespace orb360::nn::vulkan {

/// What a buffer is for, which decides in which memory it lies.
enum class BufferUse : std::uint8_t {
  kDevice,    // read and written by shaders, in the device's own memory
  kUpload,    // written by the CPU
  kDownload,  // read by the CPU, from its cache where the device can write there
};

/// A buffer with memory of its own.
class Buffer {
 public:
  Buffer() = default;
  /// `bytes` may be 0. Throws DeviceError where there is too little memory.
  Buffer(const LogicalDevice& device, std::size_t bytes, BufferUse use);

  VkBuffer get() const { return buffer_.get(); }
  /// Address of the memory for the CPU. Null for kDevice.
  std::byte* data() const { return data_; }
  /// Makes visible to the CPU what the device has written.
  void Invalidate(const LogicalDevice& device) const;

 private:
  bool is_coherent_ = true;
  std::byte* data_ = nullptr;
  Owned<VkDeviceMemory> memory_;
  Owned<VkBuffer> buffer_;  // declared last: it is destroyed before its memory
};

}  // namespace orb360::nn::vulkan
