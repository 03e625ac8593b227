#pragma once

#include <cstdint>
#include <span>

namespace orb360::nn::vulkan {

// F(name of the enumerator, name of the code): one entry for each file of nn/vulkan/shaders, and
// for those that can read and write 16-bit floats a second one, compiled with HAS_HALVES.
#define ORB360_VULKAN_SHADERS(F)                       \
  F(kAveragePool, average_pool)                        \
  F(kAveragePoolHalves, average_pool_halves)           \
  F(kConfidencePool, confidence_pool)                  \
  F(kConvexUpsample, convex_upsample)                  \
  F(kConvolution, convolution)                         \
  F(kConvolutionHalves, convolution_halves)            \
  F(kDense, dense)                                     \
  F(kElementwise, elementwise)                         \
  F(kElementwiseHalves, elementwise_halves)            \
  F(kElementwisePair, elementwise_pair)                \
  F(kElementwisePairHalves, elementwise_pair_halves)   \
  F(kFmaPeak, fma_peak)                                \
  F(kGlobalAveragePool, global_average_pool)           \
  F(kLatitudeSine, latitude_sine)                      \
  F(kMedianChoose, median_choose)                      \
  F(kMedianCount, median_count)                        \
  F(kMedianLog, median_log)                            \
  F(kMedianSelect, median_select)                      \
  F(kNormalizedConvolution, normalized_convolution)    \
  F(kUpsampleBilinear, upsample_bilinear)              \
  F(kUpsampleBilinearHalves, upsample_bilinear_halves) \
  F(kUpsampleNearest, upsample_nearest)                \
  F(kUpsampleNearestHalves, upsample_nearest_halves)

enum class Shader : std::uint8_t {
#define ORB360_ENUMERATOR(enumerator, file) enumerator,
  ORB360_VULKAN_SHADERS(ORB360_ENUMERATOR)
#undef ORB360_ENUMERATOR
};

/// Returns the variant of a shader that can read and write 16-bit floats. Contract: there is one.
Shader WithHalves(Shader shader);

/// Returns the SPIR-V of a shader, which was compiled when the library was built.
std::span<const std::uint32_t> CodeOf(Shader shader);

}  // namespace orb360::nn::vulkan
