#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A surface of triangles that share their vertices.
struct Surface {
  std::vector<Vector3f> positions;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Returns unit normals at the vertices: the mean of the triangles', weighted by their areas.
std::vector<Vector3f> VertexNormals(const Surface& surface);

/// Adds a surface with smooth normals. The texture of each triangle is projected along the axis
/// nearest to its normal, in metres, with v up where it can be; where the axis changes there is a
/// seam in the texture, and none in the surface. `material` is by triangle.
void AddBoxMapped(const Surface& surface, std::span<const MaterialId> material, MeshBuilder& b);

}  // namespace orb360::town
