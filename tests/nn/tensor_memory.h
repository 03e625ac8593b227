#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// A tensor with memory of its own, every byte of it 0x7f at first: floats of 3.4e38, which no
/// result survives that reads what nobody has written.
struct TensorMemory {
  explicit TensorMemory(const TensorFormat& format)
      : bytes(format.bytes() + kAlignment, std::byte{0x7f}) {
    void* start = bytes.data();
    std::size_t room = bytes.size();
    view = format.View(std::align(kAlignment, format.bytes(), start, room));
  }
  TensorMemory(const TensorMemory&) = delete;
  TensorMemory& operator=(const TensorMemory&) = delete;

  std::vector<std::byte> bytes;
  TensorView view;
};

/// One value of a float tensor.
inline float& At(const TensorView& tensor, int channel, int y, int x) {
  const int block = tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
  return tensor.row<float>(channel / block, y)[x * block + channel % block];
}

}  // namespace orb360::nn
