#pragma once

#include <array>
#include <vector>

#include "apps/town/world/box_mapping.h"

namespace orb360::town {

/// Values of a function on a grid in space, x first: negative in what is hollow.
struct ValueGrid {
  Vector3f origin = Vector3f::Zero();  ///< of the first value
  float cell = 1;                      ///< between neighbours, metres
  std::array<int, 3> size{};
  std::vector<float> values;

  size_t Index(int x, int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(size[1]) + static_cast<size_t>(y)) *
               static_cast<size_t>(size[0]) +
           static_cast<size_t>(x);
  }
  Vector3f At(int x, int y, int z) const {
    return origin +
           cell * Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }
};

/// Returns the surface where a function is zero, seen from where it is negative: a vertex for each
/// cell that the surface crosses, at the mean of the places where it crosses the cell's edges, and
/// two triangles for each edge that it crosses (naive surface nets, after Gibson 1998). It is
/// closed if the function is positive on the border of the grid.
Surface SurfaceNets(const ValueGrid& grid);

}  // namespace orb360::town
