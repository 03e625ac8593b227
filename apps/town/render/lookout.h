#pragma once

#include <vector>

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Returns directions over the hemisphere about +z with a density proportional to the cosine (a
/// Fibonacci spiral on the disc, projected upward).
std::vector<Vector3f> CosineDirections(int count);

/// Returns, by vertex, the point from which it looks: slightly off the surface and towards the
/// inside of a triangle, so that it does not lie in the wall next to it.
std::vector<Vector3f> LookoutPoints(const Mesh& mesh);

}  // namespace orb360::town
