#include "apps/town/render/lookout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orb360::town {

std::vector<Vector3f> CosineDirections(int count) {
  std::vector<Vector3f> directions(static_cast<size_t>(count));
  for (size_t i = 0; i < directions.size(); ++i) {
    const float squared_radius = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const float angle = std::numbers::pi_v<float> * (3 - std::sqrt(5.0F)) * static_cast<float>(i);
    directions[i] = {std::sqrt(squared_radius) * std::cos(angle),
                     std::sqrt(squared_radius) * std::sin(angle), std::sqrt(1 - squared_radius)};
  }
  return directions;
}

std::vector<Vector3f> LookoutPoints(const Mesh& mesh) {
  std::vector<Vector3f> points = mesh.positions;
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3f centre =
        (mesh.positions[triangle.vertices[0]] + mesh.positions[triangle.vertices[1]] +
         mesh.positions[triangle.vertices[2]]) /
        3;
    for (const uint32_t index : triangle.vertices) {
      const Vector3f inward = centre - mesh.positions[index];
      const float step = std::min(0.06F, 0.3F * inward.norm());  // metres
      points[index] = mesh.positions[index] + step * inward.normalized() +
                      0.02F * mesh.vertices[index].normal.cast<float>() / 127;
    }
  }
  return points;
}

}  // namespace orb360::town
