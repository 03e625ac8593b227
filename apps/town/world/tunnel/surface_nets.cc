#include "apps/town/world/tunnel/surface_nets.h"

#include <cstdint>
#include <limits>
#include <utility>

namespace orb360::town {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

/// Returns the mean of the places where the surface crosses the edges of a cell, from its first
/// corner and in cells; false if it crosses none.
bool CrossingOf(const std::array<float, 8>& corners, Vector3f* mean) {
  Vector3f sum = Vector3f::Zero();
  int count = 0;
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((corner >> axis & 1) != 0) continue;
      const float a = corners[static_cast<size_t>(corner)];
      const float b = corners[static_cast<size_t>(corner | 1 << axis)];
      if ((a < 0) == (b < 0)) continue;
      Vector3f place(static_cast<float>(corner & 1), static_cast<float>(corner >> 1 & 1),
                     static_cast<float>(corner >> 2 & 1));
      place[axis] += a / (a - b);
      sum += place;
      ++count;
    }
  }
  if (count == 0) return false;
  *mean = sum / static_cast<float>(count);
  return true;
}

}  // namespace

Surface SurfaceNets(const ValueGrid& grid) {
  Surface surface;
  std::vector<uint32_t> vertices(grid.values.size(), kNone);  // by the first corner of the cell
  const auto [nx, ny, nz] = grid.size;
  for (int z = 0; z + 1 < nz; ++z) {
    for (int y = 0; y + 1 < ny; ++y) {
      for (int x = 0; x + 1 < nx; ++x) {
        std::array<float, 8> corners{};
        for (int i = 0; i < 8; ++i)
          corners[static_cast<size_t>(i)] =
              grid.values[grid.Index(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2 & 1))];
        Vector3f mean;
        if (!CrossingOf(corners, &mean)) continue;
        vertices[grid.Index(x, y, z)] = static_cast<uint32_t>(surface.positions.size());
        surface.positions.push_back(grid.At(x, y, z) + grid.cell * mean);
      }
    }
  }
  // An edge along `axis` is shared by four cells, which lie around it.
  for (int z = 1; z + 1 < nz; ++z) {
    for (int y = 1; y + 1 < ny; ++y) {
      for (int x = 1; x + 1 < nx; ++x) {
        const float here = grid.values[grid.Index(x, y, z)];
        for (int axis = 0; axis < 3; ++axis) {
          std::array<int, 3> next = {x, y, z};
          ++next[static_cast<size_t>(axis)];
          const float there = grid.values[grid.Index(next[0], next[1], next[2])];
          if ((here < 0) == (there < 0)) continue;
          std::array<int, 3> u{};
          std::array<int, 3> v{};
          u[static_cast<size_t>((axis + 1) % 3)] = 1;
          v[static_cast<size_t>((axis + 2) % 3)] = 1;
          const auto cell = [&](int i, int k) {
            return vertices[grid.Index(x - i * u[0] - k * v[0], y - i * u[1] - k * v[1],
                                       z - i * u[2] - k * v[2])];
          };
          // Counter-clockwise about the axis; it is seen from the hollow end of the edge.
          std::array<uint32_t, 4> quad = {cell(1, 1), cell(0, 1), cell(0, 0), cell(1, 0)};
          if (here < 0) std::swap(quad[1], quad[3]);
          surface.triangles.push_back({quad[0], quad[1], quad[2]});
          surface.triangles.push_back({quad[0], quad[2], quad[3]});
        }
      }
    }
  }
  return surface;
}

}  // namespace orb360::town
