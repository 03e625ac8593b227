#include "nn/kernels/copy_channels.h"

#include <algorithm>
#include <cstring>

#include "nn/base/bfloat16.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

float Converted(float value, const float*) { return value; }
BFloat16 Converted(float value, const BFloat16*) { return ToBFloat16(value); }

// Returns the number of channels of a pixel that are adjacent.
int StepOf(const TensorView& tensor) {
  return tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
}

// Data that the copied channels of one row have in common.
struct Row {
  int y;
  int from_first;
  int to_first;
  int count;
};

// Copies channel by channel, for any layouts and types, in parts of a row whose blocks stay in the
// first-level cache until all their channels are written.
template <typename From, typename To>
void CopySingly(const TensorView& from, const TensorView& to, const Row& row) {
  constexpr int kPixels = 128;
  const int from_step = StepOf(from);
  const int to_step = StepOf(to);
  // A last block that is not full ends with zeros.
  const int in_last = to.shape.channels % to_step;
  const bool ends_block = row.to_first + row.count == to.shape.channels && in_last != 0;
  for (int first = 0; first < to.shape.width; first += kPixels) {
    const int last = std::min(first + kPixels, to.shape.width);
    for (int i = 0; i < row.count; ++i) {
      const int source = row.from_first + i;
      const int target = row.to_first + i;
      const From* read = from.row<From>(source / from_step, row.y) + source % from_step;
      To* write = to.row<To>(target / to_step, row.y) + target % to_step;
      for (int x = first; x < last; ++x) {
        write[x * to_step] = Converted(ToFloat(read[x * from_step]), write);
      }
    }
    if (!ends_block) continue;
    To* block = to.row<To>(to.shape.channels / to_step, row.y);
    for (int x = first; x < last; ++x) {
      std::fill(block + x * to_step + in_last, block + (x + 1) * to_step, To{});
    }
  }
}

// Copies whole blocks between types. A block of bfloat16 holds the channels of two blocks of
// floats, of which the second may not exist.
void RoundBlocks(const TensorView& from, const TensorView& to, const Row& row) {
  constexpr int kFloats = BlockOf(DataType::kFloat);
  constexpr int kHalves = BlockOf(DataType::kBFloat16);
  for (int i = 0; i < row.count; i += kFloats) {
    const float* read = from.row<float>((row.from_first + i) / kFloats, row.y);
    const int target = row.to_first + i;
    BFloat16* write = to.row<BFloat16>(target / kHalves, row.y) + target % kHalves;
    const bool is_last = i + kFloats >= row.count && target % kHalves == 0;
    for (int x = 0; x < to.shape.width; ++x) {
      for (int lane = 0; lane < kFloats; ++lane) {
        write[x * kHalves + lane] = ToBFloat16(read[x * kFloats + lane]);
      }
      if (!is_last) continue;
      for (int lane = kFloats; lane < kHalves; ++lane) write[x * kHalves + lane] = {};
    }
  }
}

void WidenBlocks(const TensorView& from, const TensorView& to, const Row& row) {
  constexpr int kFloats = BlockOf(DataType::kFloat);
  constexpr int kHalves = BlockOf(DataType::kBFloat16);
  for (int i = 0; i < row.count; i += kFloats) {
    const int source = row.from_first + i;
    const BFloat16* read = from.row<BFloat16>(source / kHalves, row.y) + source % kHalves;
    float* write = to.row<float>((row.to_first + i) / kFloats, row.y);
    for (int x = 0; x < to.shape.width; ++x) {
      for (int lane = 0; lane < kFloats; ++lane) {
        write[x * kFloats + lane] = ToFloat(read[x * kHalves + lane]);
      }
    }
  }
}

// Copies channels that have the same places in their blocks, of the same type.
template <typename T>
void CopyLanes(const TensorView& from, const TensorView& to, const Row& row) {
  const int block = StepOf(to);
  for (int i = 0; i < row.count;) {
    const int lane = (row.to_first + i) % block;
    const int lanes = std::min(block - lane, row.count - i);
    const T* read = from.row<T>((row.from_first + i) / block, row.y) + lane;
    T* write = to.row<T>((row.to_first + i) / block, row.y) + lane;
    const bool ends_block = row.to_first + i + lanes == to.shape.channels;
    const int fill = ends_block ? block - lane - lanes : 0;
    for (int x = 0; x < to.shape.width; ++x, read += block, write += block) {
      std::copy_n(read, lanes, write);
      std::fill_n(write + lanes, fill, T{});
    }
    i += lanes;
  }
}

// Copies whole planes of the same layout and type.
void CopyPlanes(const TensorView& from, const TensorView& to, const Row& row) {
  const int step = StepOf(to);
  const std::size_t pixel = static_cast<std::size_t>(step) * SizeOf(to.type);
  const auto at = [&](const TensorView& tensor, int plane) {
    return static_cast<std::byte*>(tensor.data) +
           (plane * tensor.plane_stride + row.y * tensor.row_stride) *
               static_cast<std::ptrdiff_t>(SizeOf(tensor.type));
  };
  for (int i = 0; i < row.count; i += step) {
    std::memcpy(at(to, (row.to_first + i) / step), at(from, (row.from_first + i) / step),
                pixel * static_cast<std::size_t>(to.shape.width));
  }
}

using CopyRow = void (*)(const TensorView&, const TensorView&, const Row&);

/// Returns the fastest function for these channels.
CopyRow Choose(const TensorView& from, int from_first, const TensorView& to, int to_first,
               int count) {
  const bool from_float = from.type == DataType::kFloat;
  const bool to_float = to.type == DataType::kFloat;
  const int step = std::max(StepOf(from), StepOf(to));
  // A last block that is not full ends with zeros, which `to` needs there too.
  const bool ends_whole = count % step == 0 || (from_first + count == from.shape.channels &&
                                                to_first + count == to.shape.channels);
  const bool are_whole =
      from.layout == to.layout && from_first % step == 0 && to_first % step == 0 && ends_whole;
  if (are_whole && from.type == to.type) return CopyPlanes;
  if (are_whole && to.layout == Layout::kBlocked) return from_float ? RoundBlocks : WidenBlocks;
  if (from.layout == Layout::kBlocked && to.layout == Layout::kBlocked && from.type == to.type &&
      from_first % step == to_first % step) {
    return from_float ? CopyLanes<float> : CopyLanes<BFloat16>;
  }
  if (from_float) return to_float ? CopySingly<float, float> : CopySingly<float, BFloat16>;
  return to_float ? CopySingly<BFloat16, float> : CopySingly<BFloat16, BFloat16>;
}

}  // namespace

void CopyChannels(const TensorView& from, int from_first, const TensorView& to, int to_first,
                  int count, int threads) {
  ORB360_CHECK(from.shape.height == to.shape.height && from.shape.width == to.shape.width);
  ORB360_CHECK(from_first >= 0 && count > 0 && from_first + count <= from.shape.channels,
               from_first, count, from.shape.channels);
  ORB360_CHECK(to_first >= 0 && to_first + count <= to.shape.channels, to_first, count,
               to.shape.channels);
  const CopyRow copy = Choose(from, from_first, to, to_first, count);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int y = 0; y < to.shape.height; ++y) copy(from, to, {y, from_first, to_first, count});
}

}  // namespace orb360::nn
