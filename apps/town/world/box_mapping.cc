#include "apps/town/world/box_mapping.h"

#include <map>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360::town {

std::vector<Vector3f> VertexNormals(const Surface& surface) {
  std::vector<Vector3f> normals(surface.positions.size(), Vector3f::Zero());
  for (const auto& [a, b, c] : surface.triangles) {
    const Vector3f& p = surface.positions[a];
    const Vector3f across = (surface.positions[b] - p).cross(surface.positions[c] - p);
    for (const uint32_t i : {a, b, c}) normals[i] += across;
  }
  for (Vector3f& normal : normals) {
    const float length = normal.norm();
    normal = length > 0 ? Vector3f(normal / length) : Vector3f(0, 0, 1);
  }
  return normals;
}

void AddBoxMapped(const Surface& surface, std::span<const MaterialId> material, MeshBuilder& b) {
  ORB360_CHECK(material.size() == surface.triangles.size(), material.size(),
               surface.triangles.size());
  const std::vector<Vector3f> normals = VertexNormals(surface);
  // A vertex is added once for each axis and scale of the textures that meet there.
  std::map<std::pair<uint32_t, std::pair<int, float>>, uint32_t> added;
  for (size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& corners = surface.triangles[i];
    const Vector3f& p = surface.positions[corners[0]];
    const Vector3f across =
        (surface.positions[corners[1]] - p).cross(surface.positions[corners[2]] - p);
    int axis = 0;
    across.cwiseAbs().maxCoeff(&axis);
    const float scale = b.materials()[material[i]].tiles_per_metre;
    std::array<uint32_t, 3> index{};
    for (size_t k = 0; k < 3; ++k) {
      const auto [entry, is_new] = added.try_emplace({corners[k], {axis, scale}}, 0U);
      if (is_new) {
        const Vector3f& q = surface.positions[corners[k]];
        const float u = axis == 0 ? q.y() : q.x();
        const float v = axis == 2 ? q.y() : q.z();
        entry->second = b.AddVertex(q, normals[corners[k]], scale * u, scale * v);
      }
      index[k] = entry->second;
    }
    b.AddTriangle(material[i], index[0], index[1], index[2]);
  }
}

}  // namespace orb360::town
