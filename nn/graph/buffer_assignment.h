#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nn/graph/lowering.h"
#include "nn/graph/memory_plan.h"

namespace orb360::nn {

/// Position of the values of a network in one block of memory.
struct BufferAssignment {
  /// For each value: its format with the halo of the whole of which it is a part, the offset of the
  /// whole, and the value's first channel in it.
  struct Buffer {
    TensorFormat whole;
    std::size_t offset = 0;  // bytes
    int first_channel = 0;
  };
  std::vector<Buffer> buffers;
  std::vector<std::size_t> scratch;  // by instruction: where its scratch starts, bytes
  std::vector<Lifetime> pieces;      // of memory, for whoever wants to check the plan
  std::vector<std::size_t> offsets;  // of the pieces
  std::size_t bytes = 0;             // of the block
  std::size_t separate_bytes = 0;    // if every value and scratch had memory of its own
};

/// Plans the memory of a lowered graph whose instructions need `scratch_bytes` each. Parts lie in
/// their wholes, results replace inputs that are read for the last time if the kernel allows it,
/// and the rest is packed by lifetime (memory_plan.h). With `keeps_values` every value keeps its
/// memory to the end.
BufferAssignment AssignBuffers(const Lowered& lowered, std::span<const std::size_t> scratch_bytes,
                               bool keeps_values);

/// Returns the value in the block that starts at `memory`.
TensorView ViewOf(const BufferAssignment::Buffer& buffer, int channels, std::byte* memory);

}  // namespace orb360::nn
