#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "nn/vulkan/shaders.h"

namespace orb360::nn::vulkan {

/// A shader with the constants that it is compiled with: width and height of its workgroups, then
/// those of the shader, in the order of their ids.
struct PipelineKey {
  Shader shader = Shader::kElementwise;
  std::vector<std::uint32_t> constants;
  friend auto operator<=>(const PipelineKey&, const PipelineKey&) = default;
};

/// One launch of a shader.
struct Dispatch {
  PipelineKey pipeline;
  std::vector<std::uint32_t> parameters;  // its push constants
  std::array<std::uint32_t, 3> groups{};  // number of workgroups in x, y and z
};

}  // namespace orb360::nn::vulkan
