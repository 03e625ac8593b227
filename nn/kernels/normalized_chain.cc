#include "nn/kernels/normalized_chain.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "nn/kernels/normalized_rows.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr int kBand = 16;  // rows that are worth a thread

int RoundUp(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

// The rows that one layer reads, as products and confidences with their padding: the latest few
// rows of the image, and all rows beyond its top and bottom edge.
class RowWindow {
 public:
  RowWindow(const NormalizedConvolution& layer, int height, int width, float* memory)
      : layer_(layer), height_(height), width_(width), memory_(memory) {
    if (layer.padding() == Padding::kZero) {
      float* beyond = memory + rows() * SlotFloats(layer, width);
      std::fill_n(beyond, 2 * layer.reach() * SlotFloats(layer, width), 0.0f);
    }
  }

  static std::size_t Floats(const NormalizedConvolution& layer, int width) {
    return (Rows(layer) + 2 * layer.reach()) * SlotFloats(layer, width);
  }

  /// Memory to which row y of the image must be written.
  NormalizedRow Writable(int y) const { return Slot(y % rows()); }

  /// Must be called when row y has been written. Adds its padding, and the rows beyond the poles
  /// that continue it.
  void Finish(int y) const {
    const NormalizedRow row = Writable(y);
    Wrap(row);
    if (layer_.padding() != Padding::kWrapCrossPole) return;
    for (int i = 0; i < layer_.reach(); ++i) {
      // In an image lower than the padding, rows continue beyond the other pole.
      const int beyond = i % (2 * height_);
      const int from_pole = beyond < height_ ? beyond : 2 * height_ - 1 - beyond;
      const int shift = beyond < height_ ? width_ / 2 : 0;
      if (y == from_pole) CopyTurned(row, shift, Beyond(-1 - i));
      if (y == height_ - 1 - from_pole) CopyTurned(row, shift, Beyond(height_ + i));
    }
  }

  /// Returns row y, which may lie up to reach() rows beyond the edge.
  NormalizedRow Readable(int y) const {
    if (y >= 0 && y < height_) return Writable(y);
    if (layer_.padding() == Padding::kWrapReplicate) return Writable(y < 0 ? 0 : height_ - 1);
    return Beyond(y);
  }

 private:
  // Number of rows that the windows of the rows computed at once cover. As rows that are written at
  // once need not end where the windows end, some further rows may exist already.
  static int Rows(const NormalizedConvolution& layer) {
    return layer.size() + 2 * (kNormalizedRows - 1);
  }
  static std::size_t RowFloats(int width) {
    return RoundUp(width, kNormalizedTile) + 2 * kNormalizedRowMargin;
  }
  static std::size_t SlotFloats(const NormalizedConvolution& layer, int width) {
    return 2 * layer.inputs() * RowFloats(width);
  }

  int rows() const { return Rows(layer_); }
  NormalizedRow Slot(int slot) const {
    const auto stride = static_cast<std::ptrdiff_t>(RowFloats(width_));
    float* start = memory_ + slot * SlotFloats(layer_, width_) + kNormalizedRowMargin;
    return {start, start + layer_.inputs() * stride, stride, stride};
  }
  NormalizedRow Beyond(int y) const {
    return Slot(y < 0 ? rows() - 1 - y : rows() + layer_.reach() + y - height_);
  }

  // Calls edit(row) for every channel of the products and of the confidences.
  template <typename Edit>
  void ForEachChannel(const NormalizedRow& row, const Edit& edit) const {
    for (int i = 0; i < layer_.inputs(); ++i) {
      edit(row.x + i * row.x_stride);
      edit(row.c + i * row.c_stride);
    }
  }
  void Wrap(const NormalizedRow& row) const {
    ForEachChannel(row, [&](float* values) {
      const bool is_zero = layer_.padding() == Padding::kZero;
      for (int i = 0; i < layer_.reach(); ++i) {
        // An image narrower than the padding is repeated.
        values[-1 - i] = is_zero ? 0 : values[width_ - 1 - i % width_];
        values[width_ + i] = is_zero ? 0 : values[i % width_];
      }
    });
  }
  void CopyTurned(const NormalizedRow& from, int shift, const NormalizedRow& to) const {
    // Products and confidences have the same layout in every slot.
    ForEachChannel(from, [&](const float* values) {
      float* turned = to.x + (values - from.x);
      std::copy(values + shift, values + width_, turned);
      std::copy(values, values + shift, turned + width_ - shift);
    });
    Wrap(to);
  }

  const NormalizedConvolution& layer_;
  int height_;
  int width_;
  float* memory_;
};

// Computes rows first <= y < last of a chain's output on one thread: each row of each layer is
// computed when the next layer needs it.
class Band {
 public:
  Band(std::span<const NormalizedConvolution> layers, std::span<const NormalizedInput> inputs,
       const ConfidentTensor& output, const PooledOutput* pooled, int first, int last,
       float* memory)
      : layers_(layers), inputs_(inputs), output_(output), pooled_(pooled) {
    const auto [channels, height, width] = output.x.shape;
    for (std::size_t s = layers.size(); s-- > 0;) {
      last_[s] = last;
      first = std::max(first - layers[s].reach(), 0);
      last = std::min(last + layers[s].reach(), height);
      next_[s] = first;
      windows_[s].emplace(layers[s], height, width, memory);
      memory += RowWindow::Floats(layers[s], width);
    }
  }

  void Run(int first, int last) {
    for (int y = first; y < last; y += kNormalizedRows) {
      const int rows = std::min(kNormalizedRows, last - y);
      NormalizedRow out[kNormalizedRows];
      for (int i = 0; i < rows; ++i) {
        out[i] = {output_.x.row<float>(0, y + i), output_.c.row<float>(0, y + i),
                  output_.x.plane_stride, output_.c.plane_stride};
      }
      Compute(layers_.size() - 1, y, rows, out);
      if (pooled_ == nullptr) continue;
      // The pairs of rows that are complete now.
      for (int v = y / 2; 2 * v + 1 < y + rows; ++v) {
        ConfidencePoolRow(output_.x, output_.c, pooled_->tensor.x, pooled_->tensor.c, pooled_->rule,
                          v);
      }
    }
  }

 private:
  // Computes rows y to y + rows - 1 of layer s.
  void Compute(std::size_t s, int y, int rows, const NormalizedRow* out) {
    const NormalizedConvolution& layer = layers_[s];
    const auto [channels, height, width] = output_.x.shape;
    const int end = std::min(y + rows + layer.reach(), height);
    while (next_[s] < end) Append(s);
    NormalizedRow in[NormalizedConvolution::kMaxSize + kNormalizedRows - 1];
    for (int r = 0; r < layer.size() + rows - 1; ++r) {
      in[r] = windows_[s]->Readable(y + r - layer.reach());
    }
    NormalizedRows(layer, in, rows, width, out, s + 1 < layers_.size());
  }

  // Computes the next row, or the next few rows, that layer s reads.
  void Append(std::size_t s) {
    const RowWindow& window = *windows_[s];
    const int y = next_[s];
    if (s == 0) {
      Gather(y, window.Writable(y));
      next_[0] = y + 1;
    } else {
      const int rows = std::min(kNormalizedRows, last_[s - 1] - y);
      NormalizedRow out[kNormalizedRows];
      for (int i = 0; i < rows; ++i) out[i] = window.Writable(y + i);
      Compute(s - 1, y, rows, out);
      next_[s] = y + rows;
    }
    for (int done = y; done < next_[s]; ++done) window.Finish(done);
  }

  void Gather(int y, const NormalizedRow& row) const {
    std::ptrdiff_t channel = 0;
    for (const auto& [tensor, doubled] : inputs_) {
      for (int i = 0; i < tensor.x.shape.channels; ++i, ++channel) {
        const int from = doubled ? y / 2 : y;
        MultiplyRow(tensor.x.row<float>(i, from), tensor.c.row<float>(i, from),
                    output_.x.shape.width, doubled, row.x + channel * row.x_stride,
                    row.c + channel * row.c_stride);
      }
    }
  }

  std::span<const NormalizedConvolution> layers_;
  std::span<const NormalizedInput> inputs_;
  const ConfidentTensor& output_;
  const PooledOutput* pooled_;
  std::array<std::optional<RowWindow>, NormalizedChain::kMaxLayers> windows_;  // what they read
  std::array<int, NormalizedChain::kMaxLayers> next_{};  // row that each window gets next
  std::array<int, NormalizedChain::kMaxLayers> last_{};  // behind the last row of each output
};

std::size_t BandFloats(std::span<const NormalizedConvolution> layers, int width) {
  std::size_t floats = 0;
  for (const NormalizedConvolution& layer : layers) floats += RowWindow::Floats(layer, width);
  return floats;
}

void CheckPlanar(const ConfidentTensor& tensor) {
  ORB360_CHECK(tensor.x.layout == Layout::kPlanar && tensor.x.type == DataType::kFloat);
  ORB360_CHECK(tensor.c.layout == Layout::kPlanar && tensor.c.type == DataType::kFloat);
  ORB360_CHECK(tensor.x.shape == tensor.c.shape);
}

}  // namespace

NormalizedChain::NormalizedChain(std::vector<NormalizedConvolution> layers)
    : layers_(std::move(layers)) {
  ORB360_CHECK(!layers_.empty() && layers_.size() <= kMaxLayers, layers_.size());
  for (std::size_t i = 1; i < layers_.size(); ++i) {
    ORB360_CHECK(layers_[i].inputs() == layers_[i - 1].outputs(), i);
  }
}

std::size_t NormalizedChain::ScratchBytes(int width, int threads) const {
  return sizeof(float) * threads * BandFloats(layers_, width);
}

void NormalizedChain::Run(std::span<const NormalizedInput> inputs, const ConfidentTensor& output,
                          std::span<std::byte> scratch, int threads,
                          const PooledOutput* pooled) const {
  CheckPlanar(output);
  const int height = output.x.shape.height;
  const int width = output.x.shape.width;
  ORB360_CHECK(output.x.shape.channels == layers_.back().outputs(), output.x.shape.channels);
  if (pooled != nullptr) {
    CheckPlanar(pooled->tensor);
    const auto [pooled_channels, pooled_height, pooled_width] = pooled->tensor.x.shape;
    ORB360_CHECK((output.x.shape == Shape{pooled_channels, 2 * pooled_height, 2 * pooled_width}));
  }
  int read = 0;
  for (const auto& [tensor, doubled] : inputs) {
    CheckPlanar(tensor);
    const int factor = doubled ? 2 : 1;
    ORB360_CHECK(height == factor * tensor.x.shape.height, height, tensor.x.shape.height);
    ORB360_CHECK(width == factor * tensor.x.shape.width, width, tensor.x.shape.width);
    read += tensor.x.shape.channels;
  }
  ORB360_CHECK(read == layers_.front().inputs(), read, layers_.front().inputs());
  for (const NormalizedConvolution& layer : layers_) {
    ORB360_CHECK(layer.padding() != Padding::kWrapCrossPole || width % 2 == 0, width);
  }
  ORB360_CHECK(scratch.size() >= ScratchBytes(width, threads), scratch.size());
  ORB360_CHECK(reinterpret_cast<std::uintptr_t>(scratch.data()) % kAlignment == 0);
  const std::size_t band_floats = BandFloats(layers_, width);
  auto* memory = reinterpret_cast<float*>(scratch.data());
  const int bands = std::clamp(height / kBand, 1, threads);
#pragma omp parallel for num_threads(bands) schedule(static)
  for (int i = 0; i < bands; ++i) {
    // Bands begin at even rows, so that a pair of rows that is pooled is written by one thread.
    const int first = height / 2 * i / bands * 2;
    const int last = i + 1 < bands ? height / 2 * (i + 1) / bands * 2 : height;
    Band(layers_, inputs, output, pooled, first, last, memory + i * band_floats).Run(first, last);
  }
}

}  // namespace orb360::nn
