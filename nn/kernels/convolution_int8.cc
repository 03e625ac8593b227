#include "nn/kernels/convolution_int8.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orb360::nn {
namespace {

constexpr float kLargestByte = 255;
constexpr float kLargestWeight = 127;

/// One filter of one output channel: in_channels x taps, rounded to multiples of `step`. Each
/// weight absorbs the rounding remainder of the previous one, because images are smooth, and so the
/// sum of a filter's taps matters more than each of them.
void RoundFilters(std::span<const float> weight, int taps, float step,
                  std::span<std::int8_t> rounded) {
  float left = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (i % static_cast<std::size_t>(taps) == 0) left = 0;
    const float wanted = weight[i] / step + left;
    const float whole = std::clamp(std::nearbyint(wanted), -kLargestWeight, kLargestWeight);
    rounded[i] = static_cast<std::int8_t>(whole);
    left = wanted - whole;
  }
}

}  // namespace

ByteScale ByteScaleOf(float minimum, float maximum, std::int32_t lowest) {
  const float low = std::min(minimum, 0.0f);
  const float high = std::max(maximum, 0.0f);
  // An input that is always zero has any scale.
  const float steps = high > low ? kLargestByte / (high - low) : 1;
  return {steps, lowest + static_cast<std::int32_t>(std::nearbyint(-low * steps)), lowest};
}

Int8Weights PackInt8(std::span<const float> weight, int out_channels, int in_channels, int kernel,
                     const ByteScale& input) {
  const int taps = kernel * kernel;
  const std::size_t filter = static_cast<std::size_t>(in_channels) * taps;
  const int channels = (out_channels + kInt8Half - 1) / kInt8Half * kInt8Half;
  std::vector<std::int8_t> rounded(filter * out_channels);
  Int8Weights packed;
  packed.first_sum.resize(channels);
  packed.scale.resize(channels);
  for (int o = 0; o < out_channels; ++o) {
    const auto own = weight.subspan(o * filter, filter);
    float largest = 0;
    for (const float value : own) largest = std::max(largest, std::abs(value));
    const float step = largest > 0 ? largest / kLargestWeight : 1;
    const auto to = std::span(rounded).subspan(o * filter, filter);
    RoundFilters(own, taps, step, to);
    std::int32_t sum = 0;
    for (const std::int8_t value : to) sum += value;
    packed.first_sum[o] = -input.zero * sum;
    packed.scale[o] = step / input.steps;
  }
  for (int group = 0; group < channels; group += kInt8Group) {
    const int halves = std::min(kInt8Group, channels - group) / kInt8Half;
    for (int first_in = 0; first_in < in_channels; first_in += kInt8Block) {
      for (int tap = 0; tap < taps; ++tap) {
        for (int quad = first_in; quad < first_in + kInt8Block; quad += kInt8Quad) {
          for (int o = group; o < group + halves * kInt8Half; ++o) {
            for (int i = quad; i < quad + kInt8Quad; ++i) {
              const bool exists = o < out_channels && i < in_channels;
              packed.weight.push_back(exists ? rounded[o * filter + i * taps + tap]
                                             : std::int8_t{0});
            }
          }
        }
      }
    }
  }
  return packed;
}

std::size_t Int8ScratchBytes(const Shape& input, int kernel, int stride, int rows) {
  const std::size_t blocks = (input.channels + kInt8Block - 1) / kInt8Block;
  const std::size_t in_rows = static_cast<std::size_t>(rows - 1) * stride + kernel;
  const std::size_t row = static_cast<std::size_t>(input.width + kernel) * kInt8Block;
  return (blocks * in_rows * row + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace orb360::nn
