#include "nn/kernels/convolution.h"

#include <algorithm>

#include "nn/base/check.h"
#include "nn/kernels/convolution_direct.h"

namespace orb360::nn {
namespace {

constexpr int kBlock = BlockOf(DataType::kFloat);

// Output rows that are computed in one go, group of channels after group: the input they read
// stays in half of a second-level cache of 1 MiB meanwhile (the other half is for the weights), and
// every thread gets several goes, to even out what disturbs them.
int RowsInBand(const ConvolutionSpec& spec, const TensorView& input, int rows, int threads) {
  const std::size_t row_bytes = static_cast<std::size_t>(input.row_stride) * input.planes() *
                                SizeOf(input.type) * spec.stride;
  constexpr std::size_t kInputBytes = std::size_t{512} << 10;
  constexpr int kBandsPerThread = 8;
  const int fitting = static_cast<int>(std::min<std::size_t>(rows, kInputBytes / row_bytes));
  return std::max(1, std::min(fitting, rows / (threads * kBandsPerThread)));
}

}  // namespace

Convolution::Convolution(const ConvolutionSpec& spec, std::span<const float> weight,
                         std::span<const float> bias)
    : spec_(spec), groups_(DirectGroups(spec.out_channels)) {
  ORB360_CHECK(spec.in_channels > 0 && spec.out_channels > 0, spec.in_channels, spec.out_channels);
  ORB360_CHECK(spec.kernel == 1 || spec.kernel == 3 || spec.kernel == 5, spec.kernel);
  ORB360_CHECK(spec.stride == 1 || spec.stride == 2, spec.stride);
  const int taps = spec.kernel * spec.kernel;
  ORB360_CHECK(
      weight.size() == static_cast<std::size_t>(spec.out_channels) * spec.in_channels * taps,
      weight.size());
  ORB360_CHECK(bias.empty() || bias.size() == static_cast<std::size_t>(spec.out_channels),
               bias.size());
  const int planes = (spec.out_channels + kBlock - 1) / kBlock;
  bias_.resize(static_cast<std::size_t>(planes) * kBlock);
  std::copy(bias.begin(), bias.end(), bias_.begin());
  weight_.resize(static_cast<std::size_t>(planes) * kBlock * spec.in_channels * taps);
  float* next = weight_.data();
  int first_out = 0;
  for (const int blocks : groups_) {
    for (int first_in = 0; first_in < spec.in_channels; first_in += kBlock) {
      for (int tap = 0; tap < taps; ++tap) {
        for (int i = first_in; i < std::min(first_in + kBlock, spec.in_channels); ++i) {
          for (int o = first_out; o < first_out + blocks * kBlock; ++o) {
            *next++ =
                o < spec.out_channels
                    ? weight[(static_cast<std::size_t>(o) * spec.in_channels + i) * taps + tap]
                    : 0;
          }
        }
      }
    }
    first_out += blocks * kBlock;
  }
}

Shape Convolution::OutputShape(const Shape& input) const {
  return {spec_.out_channels, (input.height + spec_.stride - 1) / spec_.stride,
          (input.width + spec_.stride - 1) / spec_.stride};
}

void Convolution::Run(const TensorView& input, const TensorView* residual, const TensorView& output,
                      int threads) const {
  ORB360_CHECK(input.shape.channels == spec_.in_channels, input.shape.channels, spec_.in_channels);
  ORB360_CHECK(input.layout == Layout::kBlocked || spec_.in_channels <= kMaxPlanarChannels,
               spec_.in_channels);
  ORB360_CHECK(output.shape == OutputShape(input.shape));
  ORB360_CHECK(input.type == DataType::kFloat && output.type == DataType::kFloat);
  ORB360_CHECK(residual == nullptr ||
               (residual->shape == output.shape && residual->layout == output.layout &&
                residual->type == output.type));
  FillHalo(input, spec_.padding, spec_.kernel / 2);
  const DirectConvolution run{
      spec_.kernel,   spec_.stride, spec_.slope, &groups_,
      weight_.data(), bias_.data(), input,       residual == nullptr ? TensorView{} : *residual,
      output};
  const int rows = output.shape.height;
  const int band = RowsInBand(spec_, input, rows, threads);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (int first = 0; first < rows; first += band) {
    RunDirect(run, first, std::min(rows, first + band));
  }
}

}  // namespace orb360::nn
