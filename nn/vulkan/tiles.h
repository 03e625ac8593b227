#pragma once

#include <cstddef>

#include <orb360/nn/tensor.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn::vulkan {

/// Limits of a workgroup, which every device with Vulkan 1.2 keeps.
constexpr int kMaxInvocations = 128;
constexpr int kMaxSharedBytes = 16384;

/// Workgroup of shaders in which each invocation has a pixel.
constexpr int kGroupWidth = 32;
constexpr int kGroupHeight = 4;

/// How shaders/convolution.comp divides its work.
struct ConvolutionTile {
  int width = 0;    // invocations of a workgroup
  int height = 0;   // likewise
  int columns = 0;  // pixels of an invocation, `width` apart
  int vectors = 0;  // of four output channels, of an invocation
  int chunk = 0;    // input channels in shared memory at once
};

/// Number of tiles to choose from.
constexpr std::size_t kTileCount = 6;

/// Chooses the tile by the kind of device: one with which each invocation computes much per value
/// that it reads, as long as there are enough workgroups for all processors of the device. No
/// result depends on it.
ConvolutionTile ChooseTile(VulkanDevice::Type device, int kernel, int stride, int in_channels,
                           const Shape& output);

/// Returns the number of workgroups of ChooseTile's tile for a length of `size`.
constexpr int GroupsFor(int size, int per_group) { return (size + per_group - 1) / per_group; }

}  // namespace orb360::nn::vulkan
