#include "nn/vulkan/half_storage.h"

#include <cstddef>
#include <variant>
#include <vector>

#include "nn/vulkan/dispatches.h"

namespace orb360::nn::vulkan {
namespace {

/// As many as make most of the traffic of memory; depths, positions and confidences have fewer.
constexpr int kManyChannels = 16;

std::size_t WholeOf(const Lowered& lowered, int value) {
  while (lowered.values[static_cast<std::size_t>(value)].whole >= 0) {
    value = lowered.values[static_cast<std::size_t>(value)].whole;
  }
  return static_cast<std::size_t>(value);
}

}  // namespace

void UseHalves(std::span<const FusedNode> nodes, Lowered* lowered) {
  std::vector<bool> can_be_half(lowered->values.size());  // by value that is a whole
  for (std::size_t i = 0; i < can_be_half.size(); ++i) {
    can_be_half[i] = lowered->values[i].format.shape.channels >= kManyChannels;
  }
  const auto forbid = [&](std::span<const int> values) {
    for (const int value : values) can_be_half[WholeOf(*lowered, value)] = false;
  };
  forbid(lowered->inputs);
  forbid(lowered->outputs);
  for (const Instruction& instruction : lowered->instructions) {
    const auto* const node = std::get_if<std::size_t>(&instruction.work);
    if (node == nullptr || CanUseHalves(nodes[*node].node.operation)) continue;
    forbid(instruction.inputs);
    forbid(instruction.outputs);
  }
  for (std::size_t i = 0; i < lowered->values.size(); ++i) {
    if (!can_be_half[WholeOf(*lowered, static_cast<int>(i))]) continue;
    lowered->values[i].format.type = DataType::kFloat16;
  }
}

}  // namespace orb360::nn::vulkan
