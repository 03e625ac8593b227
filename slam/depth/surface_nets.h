#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/surface_point.h"

namespace orb360 {

/// How a surface is laid through the points of a cloud. All lengths are in cells, which are cubes
/// of one size.
struct SurfaceNetsOptions {
  /// Farthest distance at which a point bears on the surface.
  double radius = 2.5;
  /// Least number of points within the radius of each corner of a cell that the surface crosses.
  int min_points = 6;
  /// The surface ends this far from the last cell that contains a point, at most 2.
  int max_gap = 1;
};

/// Index of a cell: the floor of a position divided by the size of the cells.
using CellIndex = std::array<std::int32_t, 3>;

/// The part of a surface in one cube of cells. Vertices at which neighbouring cubes meet belong to
/// one of them; the triangles of the other refer to their cells.
struct SurfacePart {
  std::vector<SurfacePoint> vertices;
  /// The cell of each vertex; there is at most one in a cell.
  std::vector<CellIndex> cells;
  /// Corners of the triangles, counterclockwise as seen from the cameras: cells of this cube, or of
  /// those before it along an axis.
  std::vector<std::array<CellIndex, 3>> triangles;
};

/// Number of cells outside a cube in which points bear on the part of the surface in the cube.
int SurfaceMargin(const SurfaceNetsOptions& options);

/// Lays a surface through oriented points (moving least squares: at each corner of a cell the mean
/// distance from the tangent planes of the points around it, weighted by nearness and by their
/// confidence; Kolluri 2005) and extracts it where that distance is zero, with one vertex in each
/// cell that it crosses (naive surface nets; Gibson 1998). Holes in the cloud remain holes.
///
/// `points` contains all points whose cells are at most SurfaceMargin cells outside the cube that
/// begins at the cell `first` and has `side` (a multiple of 32) cells along each axis, and no
/// others. `cell_size` is in the unit of the points. The parts of neighbouring cubes fit each other
/// exactly where their points are in the same order. The result does not depend on the number of
/// threads.
SurfacePart ExtractSurface(std::span<const SurfacePoint> points, const CellIndex& first, int side,
                           double cell_size, const SurfaceNetsOptions& options, int num_threads);

}  // namespace orb360
