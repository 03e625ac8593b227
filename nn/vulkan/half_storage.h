#pragma once

#include <span>

#include "nn/graph/fusion.h"
#include "nn/graph/lowering.h"

namespace orb360::nn::vulkan {

/// Makes tensors 16-bit floats (DataType::kFloat16) that are read and written only by operations
/// which can (CanUseHalves) and have many channels: the results of convolutions between the first
/// and the last ones. Inputs and outputs of the network, positions and logarithms keep their
/// digits.
void UseHalves(std::span<const FusedNode> nodes, Lowered* lowered);

}  // namespace orb360::nn::vulkan
