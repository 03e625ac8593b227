#pragma once

#include <functional>
#include <utility>

#include "nn/vulkan/functions.h"

namespace orb360::nn::vulkan {

/// A handle of Vulkan that is destroyed with this object.
template <typename Handle>
class Owned {
 public:
  Owned() = default;
  Owned(Handle handle, std::function<void(Handle)> destroy)
      : handle_(handle), destroy_(std::move(destroy)) {}
  Owned(Owned&& other) noexcept
      : handle_(std::exchange(other.handle_, VK_NULL_HANDLE)),
        destroy_(std::move(other.destroy_)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(handle_, other.handle_);
    std::swap(destroy_, other.destroy_);
    return *this;
  }
  ~Owned() {
    if (handle_ != VK_NULL_HANDLE) destroy_(handle_);
  }

  Handle get() const { return handle_; }

 private:
  Handle handle_ = VK_NULL_HANDLE;
  std::function<void(Handle)> destroy_;
};

}  // namespace orb360::nn::vulkan
