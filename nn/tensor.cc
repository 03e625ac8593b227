#include <cstring>

#include "nn/base/bfloat16.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {
namespace {

std::ptrdiff_t RoundUp(std::ptrdiff_t value, std::ptrdiff_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

std::ptrdiff_t PixelStride(const TensorView& tensor) {
  return tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
}

float LoadFloat(const void* data, DataType type, std::ptrdiff_t index) {
  return type == DataType::kFloat ? static_cast<const float*>(data)[index]
                                  : ToFloat(static_cast<const BFloat16*>(data)[index]);
}

void StoreFloat(void* data, DataType type, std::ptrdiff_t index, float value) {
  if (type == DataType::kFloat) {
    static_cast<float*>(data)[index] = value;
  } else {
    static_cast<BFloat16*>(data)[index] = ToBFloat16(value);
  }
}

// Returns the offset of a channel of a pixel from `data`.
std::ptrdiff_t Offset(const TensorView& tensor, int channel, int y, int x) {
  const int block = static_cast<int>(PixelStride(tensor));
  return channel / block * tensor.plane_stride + y * tensor.row_stride + std::ptrdiff_t{x} * block +
         channel % block;
}

}  // namespace

std::ptrdiff_t TensorFormat::row_stride() const {
  const std::ptrdiff_t per_line = BlockOf(type);
  if (layout == Layout::kBlocked) return (shape.width + 2 * halo) * per_line;
  // Each halo of a planar row is as wide as a cache line, so that the row's first pixel is aligned.
  return RoundUp(shape.width, per_line) + (halo > 0 ? 2 * RoundUp(halo, per_line) : 0);
}

std::ptrdiff_t TensorFormat::plane_stride() const {
  // One cache line more than the rows: planes a power of two apart would all map to the same few
  // lines of a cache, and kernels read and write many planes side by side.
  return row_stride() * (shape.height + 2 * halo) + BlockOf(type);
}

std::size_t TensorFormat::bytes() const {
  const std::ptrdiff_t block = layout == Layout::kBlocked ? BlockOf(type) : 1;
  return static_cast<std::size_t>((shape.channels + block - 1) / block * plane_stride()) *
         SizeOf(type);
}

TensorView TensorFormat::View(void* memory) const {
  ORB360_CHECK(reinterpret_cast<std::uintptr_t>(memory) % kAlignment == 0);
  const std::ptrdiff_t per_line = BlockOf(type);
  const std::ptrdiff_t left =
      layout == Layout::kBlocked ? halo * per_line : RoundUp(halo, per_line);
  const std::ptrdiff_t first = halo * row_stride() + left;
  return {static_cast<std::byte*>(memory) + static_cast<std::size_t>(first) * SizeOf(type),
          shape,
          layout,
          type,
          halo,
          row_stride(),
          plane_stride()};
}

TensorView ChannelSlice(const TensorView& tensor, int first, int count) {
  const auto block = static_cast<int>(PixelStride(tensor));
  ORB360_CHECK(first >= 0 && count > 0 && first + count <= tensor.shape.channels, first, count);
  ORB360_CHECK(first % block == 0, first, block);
  TensorView slice = tensor;
  slice.shape.channels = count;
  slice.data = static_cast<std::byte*>(tensor.data) +
               static_cast<std::size_t>(first / block * tensor.plane_stride) * SizeOf(tensor.type);
  return slice;
}

void FillHalo(const TensorView& tensor, Padding padding, int width) {
  ORB360_CHECK(width <= tensor.halo, width, tensor.halo);
  const auto [channels, rows, columns] = tensor.shape;
  ORB360_CHECK(padding != Padding::kWrapCrossPole || columns % 2 == 0, columns);
  const std::size_t pixel = static_cast<std::size_t>(PixelStride(tensor)) * SizeOf(tensor.type);
  const auto at = [&](int plane, int y, int x) {
    return tensor.row<std::byte>(0, 0) +
           (plane * tensor.plane_stride + y * tensor.row_stride) *
               static_cast<std::ptrdiff_t>(SizeOf(tensor.type)) +
           x * static_cast<std::ptrdiff_t>(pixel);
  };
  for (int plane = 0; plane < tensor.planes(); ++plane) {
    for (int y = 0; y < rows; ++y) {
      for (int i = 0; i < width; ++i) {
        if (padding == Padding::kZero) {
          std::memset(at(plane, y, -1 - i), 0, pixel);
          std::memset(at(plane, y, columns + i), 0, pixel);
        } else {
          // An image narrower than the halo is repeated.
          std::memcpy(at(plane, y, -1 - i), at(plane, y, columns - 1 - i % columns), pixel);
          std::memcpy(at(plane, y, columns + i), at(plane, y, i % columns), pixel);
        }
      }
    }
    for (int i = 0; i < width; ++i) {
      for (const bool top : {true, false}) {
        const int y = top ? -1 - i : rows + i;
        const std::size_t whole = static_cast<std::size_t>(columns + 2 * width) * pixel;
        if (padding == Padding::kZero) {
          std::memset(at(plane, y, -width), 0, whole);
        } else if (padding == Padding::kWrapReplicate) {
          std::memcpy(at(plane, y, -width), at(plane, top ? 0 : rows - 1, -width), whole);
        } else {
          // In an image lower than the halo, rows continue beyond the other pole.
          const int beyond = i % (2 * rows);
          const int from_pole = beyond < rows ? beyond : 2 * rows - 1 - beyond;
          const int shift = beyond < rows ? columns / 2 : 0;
          const int source = top ? from_pole : rows - 1 - from_pole;
          for (int x = -width; x < columns + width; ++x) {
            const int wrapped = ((x + shift) % columns + columns) % columns;
            std::memcpy(at(plane, y, x), at(plane, source, wrapped), pixel);
          }
        }
      }
    }
  }
}

void Reorder(const TensorView& from, const TensorView& to) {
  ORB360_CHECK(from.shape == to.shape);
  const auto [channels, rows, columns] = to.shape;
  const int block = static_cast<int>(PixelStride(to));
  // The channels that fill up the last block are written too, with zeros.
  const int whole = to.planes() * block;
  for (int channel = 0; channel < whole; ++channel) {
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const float value =
            channel < channels ? LoadFloat(from.data, from.type, Offset(from, channel, y, x)) : 0;
        StoreFloat(to.data, to.type, Offset(to, channel, y, x), value);
      }
    }
  }
}

}  // namespace orb360::nn
