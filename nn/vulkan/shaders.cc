#include "nn/vulkan/shaders.h"

#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

// The folder of the .inc files, which the build makes, is on the include path.
constexpr std::uint32_t average_pool[] = {
#include "average_pool.inc"
};
constexpr std::uint32_t average_pool_halves[] = {
#include "average_pool_halves.inc"
};
constexpr std::uint32_t confidence_pool[] = {
#include "confidence_pool.inc"
};
constexpr std::uint32_t convex_upsample[] = {
#include "convex_upsample.inc"
};
constexpr std::uint32_t convolution[] = {
#include "convolution.inc"
};
constexpr std::uint32_t convolution_halves[] = {
#include "convolution_halves.inc"
};
constexpr std::uint32_t dense[] = {
#include "dense.inc"
};
constexpr std::uint32_t elementwise[] = {
#include "elementwise.inc"
};
constexpr std::uint32_t elementwise_halves[] = {
#include "elementwise_halves.inc"
};
constexpr std::uint32_t elementwise_pair[] = {
#include "elementwise_pair.inc"
};
constexpr std::uint32_t elementwise_pair_halves[] = {
#include "elementwise_pair_halves.inc"
};
constexpr std::uint32_t fma_peak[] = {
#include "fma_peak.inc"
};
constexpr std::uint32_t global_average_pool[] = {
#include "global_average_pool.inc"
};
constexpr std::uint32_t latitude_sine[] = {
#include "latitude_sine.inc"
};
constexpr std::uint32_t median_choose[] = {
#include "median_choose.inc"
};
constexpr std::uint32_t median_count[] = {
#include "median_count.inc"
};
constexpr std::uint32_t median_log[] = {
#include "median_log.inc"
};
constexpr std::uint32_t median_select[] = {
#include "median_select.inc"
};
constexpr std::uint32_t normalized_convolution[] = {
#include "normalized_convolution.inc"
};
constexpr std::uint32_t upsample_bilinear[] = {
#include "upsample_bilinear.inc"
};
constexpr std::uint32_t upsample_bilinear_halves[] = {
#include "upsample_bilinear_halves.inc"
};
constexpr std::uint32_t upsample_nearest[] = {
#include "upsample_nearest.inc"
};
constexpr std::uint32_t upsample_nearest_halves[] = {
#include "upsample_nearest_halves.inc"
};

}  // namespace

Shader WithHalves(Shader shader) {
  switch (shader) {
    case Shader::kAveragePool:
      return Shader::kAveragePoolHalves;
    case Shader::kConvolution:
      return Shader::kConvolutionHalves;
    case Shader::kElementwise:
      return Shader::kElementwiseHalves;
    case Shader::kElementwisePair:
      return Shader::kElementwisePairHalves;
    case Shader::kUpsampleBilinear:
      return Shader::kUpsampleBilinearHalves;
    case Shader::kUpsampleNearest:
      return Shader::kUpsampleNearestHalves;
    default:
      ORB360_CHECK(false, static_cast<int>(shader));
  }
  return shader;
}

std::span<const std::uint32_t> CodeOf(Shader shader) {
  switch (shader) {
#define ORB360_CASE(enumerator, file) \
  case Shader::enumerator:            \
    return file;
    ORB360_VULKAN_SHADERS(ORB360_CASE)
#undef ORB360_CASE
  }
  return {};
}

}  // namespace orb360::nn::vulkan
