#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nn/graph/fusion.h"
#include "nn/vulkan/constants.h"
#include "nn/vulkan/dispatch.h"
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/tensor.h>
#include <orb360/nn/vulkan/devices.h>

namespace orb360::nn::vulkan {

/// Where a tensor lies: planes of 32-bit or 16-bit floats without halo. In elements, from the start
/// of the memory of a run (View in shaders/common.glsl).
struct Place {
  Shape shape;
  bool is_half = false;
  std::uint32_t offset = 0;
  std::uint32_t row = 0;
  std::uint32_t plane = 0;
};

/// Returns the bytes of scratch memory that the shaders of a node need.
std::size_t ScratchBytes(const Operation& operation);

/// Returns whether the shaders of an operation can read and write 16-bit floats.
bool CanUseHalves(const Operation& operation);

/// What the shaders of a node work on.
struct Operands {
  std::vector<Place> inputs;
  std::vector<Place> outputs;
  std::uint32_t scratch = 0;  // in elements
};

/// Returns the launches that compute a node, one after the other. Adds its weights to `constants`.
std::vector<Dispatch> DispatchesOf(const Graph& graph, const FusedNode& node,
                                   const Operands& operands, VulkanDevice::Type device,
                                   Constants* constants);

/// Returns the launch that copies a tensor to another one of the same shape.
Dispatch CopyOf(const Place& from, const Place& to);

}  // namespace orb360::nn::vulkan
