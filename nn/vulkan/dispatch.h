#pragma once

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "nn/vulkan/shaders.h"

namespace orb360::nn::vulkan {

/// A shader with the constants that it is compiled with: width and height of its workgroups, then
/// those of the shader, in the order of their ids.
struct PipelineKey {
  Shader shader = Shader::kElementwise;
  std::vector<std::uint32_t> constants;
  friend bool operator<(const PipelineKey& a, const PipelineKey& b) {
    return std::tie(a.shader, a.constants) < std::tie(b.shader, b.constants);
  }
};

/// One launch of a shader.
struct Dispatch {
  PipelineKey pipeline;
  std::vector<std::uint32_t> parameters;  // its push constants
  std::array<std::uint32_t, 3> groups{};  // number of workgroups in x, y and z
};

}  // namespace orb360::nn::vulkan
