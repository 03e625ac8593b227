#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "apps/town/import/quake_bsp.h"

namespace orb360::town {

/// Triangles of a face, counter-clockwise seen from the front.
struct FaceMesh {
  std::vector<QuakeVertex> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Returns the triangles of a face of any kind; none for a billboard. A patch consists of
/// biquadratic Bezier surfaces of 3 x 3 control points each, which share their borders; it is
/// tessellated so finely that its triangles lie within a quarter of a unit of it.
FaceMesh TrianglesOf(const QuakeMap& map, const QuakeFace& face);

/// Divides triangles until no edge is both longer than `longest` and wider than a pixel in the
/// pages of light, so that light interpolated between vertices is nearly that of the page. An edge
/// is divided in its middle in all triangles that share it. Throws UserError (without the name of
/// the file) if more than `max_triangles` triangles would result.
void DivideForLight(float longest, size_t max_triangles, FaceMesh* mesh);

}  // namespace orb360::town
