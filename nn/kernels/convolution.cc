#include "nn/kernels/convolution.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include <omp.h>

#include "nn/kernels/convolution_bf16.h"
#include "nn/kernels/convolution_direct.h"
#include "nn/kernels/convolution_winograd.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

static_assert(kConvolutionTile == kWinogradTile);

constexpr int kBlock = BlockOf(DataType::kFloat);

// Winograd needs a full block of input and of output channels; otherwise mostly padding would be
// transformed.
constexpr int kFewestWinogradChannels = kBlock;

// Number of output rows that are computed in one band, group of channels after group. Their input
// stays in half of a second-level cache of 1 MiB (the other half is for the weights), and every
// thread gets several bands, which evens out disturbances. In bfloat16 there are fewer bands,
// because a band reads all weights, which takes as long there as multiplying a row or two.
int RowsInBand(const ConvolutionSpec& spec, const TensorView& input, int rows, int threads) {
  const std::size_t row_bytes = static_cast<std::size_t>(input.row_stride) * input.planes() *
                                SizeOf(input.type) * spec.stride;
  constexpr std::size_t kInputBytes = std::size_t{512} << 10;
  const int bands_per_thread = spec.type == DataType::kFloat ? 8 : 2;
  const int fitting = static_cast<int>(std::min<std::size_t>(rows, kInputBytes / row_bytes));
  return std::max(1, std::min(fitting, rows / (threads * bands_per_thread)));
}

// Likewise for 8 bits: the input is rounded in bands that stay in a quarter of the second-level
// cache. Rows at the edges of bands are rounded twice.
int RowsInByteBand(const ConvolutionSpec& spec, const Shape& input, int rows, int threads) {
  constexpr std::size_t kInputBytes = std::size_t{256} << 10;
  const std::size_t row_bytes = Int8ScratchBytes(input, spec.kernel, spec.stride, 2) -
                                Int8ScratchBytes(input, spec.kernel, spec.stride, 1);
  const int fitting = static_cast<int>(
      std::min<std::size_t>(rows, kInputBytes / std::max<std::size_t>(row_bytes, 1)));
  return std::max(1, std::min(fitting, rows / (threads * 2)));
}

AlignedVector<float> PackDirect(const ConvolutionSpec& spec, std::span<const float> weight,
                                const std::vector<int>& groups) {
  const int taps = spec.kernel * spec.kernel;
  AlignedVector<float> packed;
  const int blocks_in_all = std::accumulate(groups.begin(), groups.end(), 0);
  packed.resize(static_cast<std::size_t>(blocks_in_all) * kBlock * taps * spec.in_channels);
  float* next = packed.data();
  int first_out = 0;
  for (const int blocks : groups) {
    for (int first_in = 0; first_in < spec.in_channels; first_in += kBlock) {
      for (int tap = 0; tap < taps; ++tap) {
        for (int i = first_in; i < std::min(first_in + kBlock, spec.in_channels); ++i) {
          for (int o = first_out; o < first_out + blocks * kBlock; ++o) {
            const std::size_t filter = static_cast<std::size_t>(o) * spec.in_channels + i;
            *next++ = o < spec.out_channels ? weight[filter * taps + tap] : 0;
          }
        }
      }
    }
    first_out += blocks * kBlock;
  }
  return packed;
}

// Gives every thread the same number of batches of tiles, or one less.
int CountBatches(int tiles, int stride, int threads) {
  const int batches = (tiles + MaxWinogradTiles(stride) - 1) / MaxWinogradTiles(stride);
  return std::min(tiles, (batches + threads - 1) / threads * threads);
}

void RunByTiles(const WinogradConvolution& run, const DirectConvolution& direct, std::byte* scratch,
                int threads) {
  const int height = run.output.shape.height;
  const int width = run.output.shape.width;
  const int tiles = CountWinogradTiles(run.output.shape);
  const int across = (width + kWinogradTile - 1) / kWinogradTile;
  const std::size_t bytes = WinogradScratchBytes(run.input.shape.channels, run.stride);
  const int batches = CountBatches(tiles, run.stride, threads);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (int batch = 0; batch < batches; ++batch) {
    const auto begin = static_cast<int>(std::int64_t{batch} * tiles / batches);
    const auto end = static_cast<int>((std::int64_t{batch} + 1) * tiles / batches);
    std::uint32_t left_out = RunWinograd(run, begin, end, scratch + omp_get_thread_num() * bytes);
    for (; left_out != 0; left_out &= left_out - 1) {
      const int tile = begin + std::countr_zero(left_out);
      const int y = tile / across * kWinogradTile;
      const int x = tile % across * kWinogradTile;
      RunDirect(direct,
                {y, std::min(y + kWinogradTile, height), x, std::min(x + kWinogradTile, width)});
    }
  }
}

void RunInBytes(const Int8Convolution& run, int band, std::byte* scratch, std::size_t bytes,
                int threads) {
  const int rows = run.output.shape.height;
  const auto run_band = FindByteUnit() == ByteUnit::kVnni ? RunVnni : RunDotProduct;
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (int first = 0; first < rows; first += band) {
    run_band(run, first, std::min(rows, first + band), scratch + omp_get_thread_num() * bytes);
  }
}

}  // namespace

bool ConvolutionSpec::is_winograd() const {
  return type == DataType::kFloat && kernel == 3 &&
         std::min(in_channels, out_channels) >= kFewestWinogradChannels && may_tile;
}

Convolution::Convolution(const ConvolutionSpec& spec, std::span<const float> weight,
                         std::span<const float> bias, BFloat16Unit unit)
    : spec_(spec), unit_(unit) {
  ORB360_CHECK(spec.in_channels > 0 && spec.out_channels > 0, spec.in_channels, spec.out_channels);
  ORB360_CHECK(spec.kernel == 1 || spec.kernel == 3 || spec.kernel == 5, spec.kernel);
  ORB360_CHECK(spec.stride == 1 || spec.stride == 2, spec.stride);
  ORB360_CHECK(weight.size() == static_cast<std::size_t>(spec.out_channels) * spec.in_channels *
                                    spec.kernel * spec.kernel,
               weight.size());
  ORB360_CHECK(bias.empty() || bias.size() == static_cast<std::size_t>(spec.out_channels),
               bias.size());
  ORB360_CHECK(spec.type != DataType::kBFloat16 || unit != BFloat16Unit::kNone,
               "this processor has no unit for bfloat16");
  ORB360_CHECK(spec.type != DataType::kInt8 || FindByteUnit() != ByteUnit::kNone,
               "this processor has no unit for 8 bits");
  const int block = spec.type == DataType::kBFloat16 ? BlockOf(spec.type) : kBlock;
  const int channels = (spec.out_channels + block - 1) / block * block;
  bias_.resize(channels);
  std::copy(bias.begin(), bias.end(), bias_.begin());
  if (spec.type == DataType::kInt8) {
    const bool has_signs = FindByteUnit() == ByteUnit::kDotProduct;
    scale_ = ByteScaleOf(spec.minimum, spec.maximum, has_signs ? -128 : 0);
    bytes_ = PackInt8(weight, spec.out_channels, spec.in_channels, spec.kernel, scale_);
  } else if (spec.type == DataType::kBFloat16 && !is_bfloat16_stem()) {
    rounded_weight_ = PackBFloat16(weight, spec.out_channels, spec.in_channels, spec.kernel);
  } else {
    groups_ = DirectGroups(channels);
    weight_ = PackDirect(spec, weight, groups_);
    if (spec_.is_winograd()) {
      filters_ = PackWinograd(weight, spec.out_channels, spec.in_channels, spec.stride, groups_);
    }
  }
}

std::size_t Convolution::ScratchBytes(const Shape& input, int threads) const {
  if (spec_.type == DataType::kInt8) {
    const int band = RowsInByteBand(spec_, input, OutputShape(input).height, threads);
    return threads * Int8ScratchBytes(input, spec_.kernel, spec_.stride, band);
  }
  return spec_.is_winograd() ? threads * WinogradScratchBytes(spec_.in_channels, spec_.stride) : 0;
}

Shape Convolution::OutputShape(const Shape& input) const {
  return {spec_.out_channels, (input.height + spec_.stride - 1) / spec_.stride,
          (input.width + spec_.stride - 1) / spec_.stride};
}

void Convolution::CheckTensors(const TensorView& input, const TensorView* residual,
                               const TensorView& output) const {
  const bool takes_floats = spec_.type != DataType::kBFloat16 || is_bfloat16_stem();
  ORB360_CHECK(input.shape.channels == spec_.in_channels, input.shape.channels, spec_.in_channels);
  ORB360_CHECK(input.type == (takes_floats ? DataType::kFloat : DataType::kBFloat16));
  ORB360_CHECK(input.layout == Layout::kBlocked
                   ? !is_bfloat16_stem()
                   : takes_floats && spec_.in_channels <= kMaxPlanarChannels &&
                         spec_.type != DataType::kInt8,
               spec_.in_channels);
  ORB360_CHECK(output.shape == OutputShape(input.shape));
  ORB360_CHECK(output.type == DataType::kFloat
                   ? !is_bfloat16_stem()
                   : spec_.type == DataType::kBFloat16 && output.layout == Layout::kBlocked);
  ORB360_CHECK(residual == nullptr ||
               (!is_bfloat16_stem() && residual->shape == output.shape &&
                residual->layout == output.layout && residual->type == output.type));
}

std::int64_t Convolution::RunProducts(const TensorView& input, std::span<std::byte> scratch,
                                      int threads) const {
  if (!spec_.is_winograd()) return 0;
  ORB360_CHECK(scratch.size() >= ScratchBytes(input.shape, threads), scratch.size());
  const WinogradConvolution run{spec_.stride, 1,     &groups_, filters_.data(),
                                bias_.data(), input, {},       {}};
  const int tiles = CountWinogradTiles(OutputShape(input.shape));
  const int batches = CountBatches(tiles, spec_.stride, threads);
  const std::size_t bytes = WinogradScratchBytes(spec_.in_channels, spec_.stride);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (int batch = 0; batch < batches; ++batch) {
    const auto begin = static_cast<int>(std::int64_t{batch} * tiles / batches);
    const auto end = static_cast<int>((std::int64_t{batch} + 1) * tiles / batches);
    RunWinogradProducts(run, end - begin, scratch.data() + omp_get_thread_num() * bytes);
  }
  return std::int64_t{WinogradProducts(spec_.stride)} * tiles * spec_.in_channels *
         spec_.out_channels;
}

void Convolution::Run(const TensorView& input, const TensorView* residual, const TensorView& output,
                      std::span<std::byte> scratch, int threads) const {
  CheckTensors(input, residual, output);
  const std::size_t scratch_bytes = ScratchBytes(input.shape, threads);
  ORB360_CHECK(scratch.size() >= scratch_bytes, scratch.size(), scratch_bytes);
  ORB360_CHECK(reinterpret_cast<std::uintptr_t>(scratch.data()) % kAlignment == 0);
  FillHalo(input, spec_.padding, spec_.kernel / 2);
  const TensorView added = residual == nullptr ? TensorView{} : *residual;
  const DirectConvolution direct{spec_.kernel, spec_.stride, spec_.slope, &groups_, weight_.data(),
                                 bias_.data(), input,        added,       output};
  if (spec_.is_winograd()) {
    RunByTiles(
        {spec_.stride, spec_.slope, &groups_, filters_.data(), bias_.data(), input, added, output},
        direct, scratch.data(), threads);
    return;
  }
  if (spec_.type == DataType::kInt8) {
    RunInBytes({spec_.kernel, spec_.stride, spec_.slope, scale_, &bytes_, bias_.data(), input,
                added, output},
               RowsInByteBand(spec_, input.shape, output.shape.height, threads), scratch.data(),
               scratch_bytes / threads, threads);
    return;
  }
  const BFloat16Convolution rounded{spec_.kernel, spec_.stride, spec_.slope, rounded_weight_.data(),
                                    bias_.data(), input,        added,       output};
  const int rows = output.shape.height;
  const int band = RowsInBand(spec_, input, rows, threads);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (int first = 0; first < rows; first += band) {
    const int last = std::min(rows, first + band);
    if (rounded_weight_.empty()) {
      RunDirect(direct, {first, last, 0, output.shape.width});
    } else if (unit_ == BFloat16Unit::kAmx) {
      RunAmx(rounded, first, last);
    } else {
      RunAvx512BFloat16(rounded, first, last);
    }
  }
}

}  // namespace orb360::nn
