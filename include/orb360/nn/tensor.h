#pragma once

#include <cstddef>
#include <cstdint>

/// Inference of convolutional networks on the CPU: tensors, graphs, network files and models. It
/// knows nothing of SLAM.
namespace orb360::nn {

/// Channels, rows and columns of the activations of one image. There is no batch dimension: a SLAM
/// system completes one image at a time, and several threads run one image each.
struct Shape {
  int channels = 0;  ///< Number of channels.
  int height = 0;    ///< Number of rows, pixels.
  int width = 0;     ///< Number of columns, pixels.
  /// Compares all members.
  friend bool operator==(const Shape&, const Shape&) = default;
};

/// Order of the channels of a tensor in memory.
enum class Layout : std::uint8_t {
  /// [channel][row][column], for tensors of few channels: images and normalized convolutions.
  kPlanar,
  /// [channel block][row][column][channel in block], where a block fills one cache line and one
  /// AVX-512 register: 16 channels of float, or 32 of bfloat16. The channels that fill up the last
  /// block are zero. It is for convolutions, whose inner loop becomes a sequence of broadcasts
  /// times a vector of output channels.
  kBlocked,
};

/// Type of the elements of a tensor.
enum class DataType : std::uint8_t {
  kFloat,     ///< IEEE 754 binary32.
  kBFloat16,  ///< The upper 16 bits of binary32: its exponent and 8 bits of precision.
  kFloat16,   ///< IEEE 754 binary16. Only devices other than the CPU use it.
  /// 8-bit integers. No tensor has this type: it is what convolutions round their input to where
  /// they multiply in it.
  kInt8,
};

/// Returns the size of an element in bytes.
constexpr std::size_t SizeOf(DataType type) {
  if (type == DataType::kInt8) return 1;
  return type == DataType::kFloat ? 4 : 2;
}

/// Bytes of a block of channels. Every row of every tensor is aligned to it.
constexpr int kAlignment = 64;

/// Number of channels in a block of Layout::kBlocked.
constexpr int BlockOf(DataType type) { return static_cast<int>(kAlignment / SizeOf(type)); }

/// Values around an image where a kernel reaches over its edge.
enum class Padding : std::uint8_t {
  kZero,  ///< Zeros on all sides.
  /// Columns continue at the other side (longitude); the first and last rows are repeated
  /// (latitude).
  kWrapReplicate,
  /// Columns continue at the other side. Beyond a pole the image continues along the opposite
  /// meridian: row -1-i is row i shifted by half the width. The width must be even.
  kWrapCrossPole,
};

/// A view of a tensor in memory with another owner. It includes `halo` pixels around the tensor, in
/// which kernels find their padding, so that they need not test for edges (FillHalo). Strides are
/// in elements; a plane is a channel (kPlanar) or a block of channels (kBlocked). A slice of the
/// channels of a tensor is a view too: concatenation writes tensors next to each other.
struct TensorView {
  /// Address of row 0, column 0 of the first channel, which lies behind the halo.
  void* data = nullptr;
  Shape shape;                       ///< Size without the halo.
  Layout layout = Layout::kPlanar;   ///< Order of the channels in memory.
  DataType type = DataType::kFloat;  ///< Type of the elements at `data`.
  int halo = 0;                      ///< Pixels around the tensor on each side that exist.
  std::ptrdiff_t row_stride = 0;     ///< Elements from a row to the next one of its plane.
  std::ptrdiff_t plane_stride = 0;   ///< Elements from a plane to the next one.

  /// Returns the address of column 0 of a row of a plane. Rows -halo to height + halo - 1 exist.
  /// `T` is the type of the elements.
  template <typename T>
  T* row(int plane, int y) const {
    return static_cast<T*>(data) + plane * plane_stride + y * row_stride;
  }
  /// Returns the number of planes: channels, or blocks of channels in kBlocked.
  int planes() const {
    return layout == Layout::kPlanar ? shape.channels
                                     : (shape.channels + BlockOf(type) - 1) / BlockOf(type);
  }
};

/// Layout, type, size and halo of a tensor, which the memory plan needs before there is memory.
struct TensorFormat {
  Shape shape;                       ///< Size without the halo.
  Layout layout = Layout::kPlanar;   ///< Order of the channels in memory.
  DataType type = DataType::kFloat;  ///< Type of the elements.
  int halo = 0;                      ///< Pixels around the tensor on each side.

  /// Returns the number of elements from a row to the next one, halo and alignment included.
  std::ptrdiff_t row_stride() const;
  /// Returns the number of elements from a plane to the next one: halo and a cache line included,
  /// so that planes do not lie a power of two apart.
  std::ptrdiff_t plane_stride() const;
  /// Returns the bytes of the whole tensor with its halo, a multiple of kAlignment.
  std::size_t bytes() const;
  /// Returns a view of the tensor in `memory`, which has bytes() bytes and is aligned to
  /// kAlignment.
  TensorView View(void* memory) const;
};

/// Returns a view of channels `first` to `first + count - 1` of a tensor. In kBlocked `first` must
/// be a multiple of the block.
TensorView ChannelSlice(const TensorView& tensor, int first, int count);

/// Fills `width` pixels of the halo on each side according to `padding`.
void FillHalo(const TensorView& tensor, Padding padding, int width);

/// Copies between layouts and data types; shapes must be equal. Rounds to nearest, ties to even,
/// when converting to bfloat16. The halo of `to` is not changed.
void Reorder(const TensorView& from, const TensorView& to);

}  // namespace orb360::nn
