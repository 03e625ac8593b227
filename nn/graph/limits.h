#pragma once

#include <cstddef>
#include <cstdint>

namespace orb360::nn::limits {

// The limits of a file (docs/formats/network.md). They are far above any network that this library
// is for, and no product of them overflows.
constexpr std::size_t kJsonBytes = std::size_t{4} << 20;
constexpr int kJsonDepth = 32;  // nested objects and arrays; a graph has six
constexpr std::size_t kNameBytes = 256;
constexpr std::size_t kNodes = 4096;
constexpr std::size_t kNodeInputs = 256;
constexpr int kChannels = 4096;
constexpr std::int64_t kWeights = std::int64_t{1} << 28;  // numbers, 1 GiB
constexpr int kKernelSize = 15;
constexpr int kSizeMultiple = 1 << 12;
constexpr int kMaxHalvings = 12;
constexpr int kLeastHalvings = -2;

/// Largest side of an image, pixels: the largest that image formats and libraries agree on.
constexpr int kMaxImageSide = 1 << 15;

}  // namespace orb360::nn::limits
