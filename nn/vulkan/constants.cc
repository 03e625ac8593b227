#include "nn/vulkan/constants.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace orb360::nn::vulkan {
namespace {

constexpr int kVector = 4;

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

std::uint32_t Constants::Align() {
  values_.resize((values_.size() + kVector - 1) / kVector * kVector);
  return static_cast<std::uint32_t>(values_.size());
}

void Constants::AppendKernels(const Weight& weight, int first, int group) {
  const std::size_t taps = weight.values.size() / Index(weight.shape[0]);
  for (std::size_t tap = 0; tap < taps; ++tap) {
    for (int o = first; o < first + group; ++o) {
      values_.push_back(o < weight.shape[0] ? weight.values[Index(o) * taps + tap] : 0);
    }
  }
}

std::uint32_t Constants::AddConvolution(const Weight& weight, const Weight& bias, int vectors) {
  const std::uint32_t start = Align() / kVector;
  const int group = kVector * vectors;
  const int outputs = weight.shape[0];
  for (int first = 0; first < outputs; first += group) AppendKernels(weight, first, group);
  for (int o = 0; o < (outputs + group - 1) / group * group; ++o) {
    values_.push_back(o < outputs ? bias.values[Index(o)] : 0);
  }
  return start;
}

std::uint32_t Constants::AddNormalizedConvolution(const Weight& weight, const Weight& bias) {
  const std::uint32_t start = Align() / kVector;
  const int outputs = weight.shape[0];
  for (int first = 0; first < outputs; first += kVector) AppendKernels(weight, first, kVector);
  const auto taps = static_cast<std::ptrdiff_t>(weight.values.size()) / outputs;
  for (int first = 0; first < outputs; first += kVector) {
    for (int o = first; o < first + kVector; ++o) {
      values_.push_back(o < outputs ? bias.values[Index(o)] : 0);
    }
    for (int o = first; o < first + kVector; ++o) {
      const auto kernel = weight.values.begin() + o * taps;
      const double sum = o < outputs ? std::accumulate(kernel, kernel + taps, 0.0) : 1;
      values_.push_back(static_cast<float>(1 / sum));
    }
  }
  return start;
}

std::uint32_t Constants::AddDense(const Weight& weight, const Weight& bias) {
  const std::uint32_t start = Align();
  const int outputs = weight.shape[0];
  AppendKernels(weight, 0, outputs);
  values_.insert(values_.end(), bias.values.begin(), bias.values.end());
  return start;
}

std::uint32_t Constants::AddLatitudeSines(int height) {
  const std::uint32_t start = Align();
  for (int v = 0; v < height; ++v) {
    // This is the cosine of the angle from the north pole.
    values_.push_back(static_cast<float>(std::cos(std::numbers::pi * (v + 0.5) / height)));
  }
  return start;
}

}  // namespace orb360::nn::vulkan
