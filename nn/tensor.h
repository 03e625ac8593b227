#pragma once

#include <cstddef>
#include <cstdint>

namespace orb360::nn {

/// Channels, rows and columns of one picture's activations. There is no batch: a SLAM system
/// completes one picture at a time, and several threads run one picture each.
struct Shape {
  int channels = 0;
  int height = 0;
  int width = 0;
  friend bool operator==(const Shape&, const Shape&) = default;
};

/// How the channels of a tensor lie in memory.
enum class Layout : std::uint8_t {
  /// [channel][row][column]. For few channels: normalized convolution, pictures.
  kPlanar,
  /// [channel block][row][column][channel in block], where a block fills one cache line and one
  /// AVX-512 register: 16 channels of float, 32 of bfloat16. The channels that fill up the last
  /// block are zero. For convolutions, whose inner loop then is a row of broadcasts against a
  /// vector of output channels.
  kBlocked,
};

enum class DataType : std::uint8_t { kFloat, kBFloat16 };

constexpr std::size_t SizeOf(DataType type) { return type == DataType::kFloat ? 4 : 2; }

/// Bytes of a block of channels, and what every row of every tensor is aligned to.
constexpr int kAlignment = 64;

/// Channels in a block of Layout::kBlocked.
constexpr int BlockOf(DataType type) { return static_cast<int>(kAlignment / SizeOf(type)); }

/// What stands around a picture when a kernel reaches over its edge.
enum class Padding : std::uint8_t {
  kZero,
  /// Columns continue at the other side (longitude), rows repeat the first and last (latitude).
  kWrapReplicate,
  /// Columns continue at the other side; beyond a pole the picture goes on down the opposite
  /// meridian: row -1-i is row i shifted by half the width. Width must be even.
  kWrapCrossPole,
};

/// A tensor in memory that somebody else owns, with `halo` pixels around it that belong to it:
/// kernels find their padding there instead of testing for edges (FillHalo). Strides are in
/// elements; a plane is a channel (kPlanar) or a block of channels (kBlocked). A slice of the
/// channels of a tensor is a view as well: concatenation is writing next to each other.
struct TensorView {
  void* data = nullptr;  // of row 0, column 0 of the first channel: behind the halo
  Shape shape;
  Layout layout = Layout::kPlanar;
  DataType type = DataType::kFloat;
  int halo = 0;
  std::ptrdiff_t row_stride = 0;
  std::ptrdiff_t plane_stride = 0;

  /// Start of a row of a plane. Rows -halo to height + halo - 1 exist.
  template <typename T>
  T* row(int plane, int y) const {
    return static_cast<T*>(data) + plane * plane_stride + y * row_stride;
  }
  int planes() const {
    return layout == Layout::kPlanar ? shape.channels
                                     : (shape.channels + BlockOf(type) - 1) / BlockOf(type);
  }
};

/// Where a tensor's parts lie: what the memory plan needs to know before there is memory.
struct TensorFormat {
  Shape shape;
  Layout layout = Layout::kPlanar;
  DataType type = DataType::kFloat;
  int halo = 0;

  std::ptrdiff_t row_stride() const;    // elements
  std::ptrdiff_t plane_stride() const;  // elements
  /// Bytes of the whole with its halo, a multiple of kAlignment.
  std::size_t bytes() const;
  /// The tensor in `memory`, which has bytes() bytes and is aligned to kAlignment.
  TensorView View(void* memory) const;
};

/// Channels `first` to `first + count - 1` of a tensor. In kBlocked `first` must be a multiple of
/// the block.
TensorView ChannelSlice(const TensorView& tensor, int first, int count);

/// Writes what `padding` says into `width` pixels of the halo on each side.
void FillHalo(const TensorView& tensor, Padding padding, int width);

/// Copies between layouts and data types; shapes must be equal. Rounds to nearest, ties to even,
/// on the way to bfloat16. The halo of `to` is left as it is.
void Reorder(const TensorView& from, const TensorView& to);

}  // namespace orb360::nn
