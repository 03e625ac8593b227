#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace orb360::nn {

/// Fraction of the pixels that have a depth: as many as SLAM has.
constexpr float kKnownFraction = 0.005f;

/// Random values for the input of that name of a network for depth completion. `depth` and
/// `confidence` are known at the same fraction `known` of the pixels and 0 elsewhere.
inline std::vector<float> RandomInput(const std::string& name, std::size_t size, float known) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  const bool is_sparse = name == "depth" || name == "confidence";
  std::mt19937 points(2);
  std::vector<float> values(size);
  for (float& value : values) {
    const bool is_known = !is_sparse || uniform(points) < known;
    value = is_known ? 0.01f + uniform(generator) : 0;
  }
  return values;
}

}  // namespace orb360::nn
