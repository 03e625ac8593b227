#pragma once

#include <cstdint>
#include <span>

namespace orb360::nn::vulkan {

// One entry for each file of nn/vulkan/shaders: F(name of the enumerator, name of the file).
#define ORB360_VULKAN_SHADERS(F)                    \
  F(kAveragePool, average_pool)                     \
  F(kConfidencePool, confidence_pool)               \
  F(kConvexUpsample, convex_upsample)               \
  F(kConvolution, convolution)                      \
  F(kDense, dense)                                  \
  F(kElementwise, elementwise)                      \
  F(kElementwisePair, elementwise_pair)             \
  F(kGlobalAveragePool, global_average_pool)        \
  F(kLatitudeSine, latitude_sine)                   \
  F(kMedianChoose, median_choose)                   \
  F(kMedianCount, median_count)                     \
  F(kMedianLog, median_log)                         \
  F(kMedianSelect, median_select)                   \
  F(kNormalizedConvolution, normalized_convolution) \
  F(kUpsampleBilinear, upsample_bilinear)           \
  F(kUpsampleNearest, upsample_nearest)

enum class Shader : std::uint8_t {
#define ORB360_ENUMERATOR(enumerator, file) enumerator,
  ORB360_VULKAN_SHADERS(ORB360_ENUMERATOR)
#undef ORB360_ENUMERATOR
};

/// Returns the SPIR-V of a shader, which was compiled when the library was built.
std::span<const std::uint32_t> CodeOf(Shader shader);

}  // namespace orb360::nn::vulkan
