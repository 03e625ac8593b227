#pragma once

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Divides the triangles of a mesh at the middles of their edges until none is longer than
/// `longest` metres, so that light can vary between vertices. The surfaces and their textures stay
/// as they are, and triangles that shared an edge still do. The mesh has no irradiance.
void Tessellate(float longest, Mesh* mesh);

}  // namespace orb360::town
