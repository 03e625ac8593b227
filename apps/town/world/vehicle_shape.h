#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "apps/town/world/mesh.h"
#include "apps/town/world/vehicle.h"

namespace orb360::town {

/// Dimensions of a car, metres; x runs from the tail (-length / 2) to the nose.
struct VehicleShape {
  float length;
  float width;                    ///< without the mirrors
  float belt;                     ///< height of the lower edge of the windows
  float roof;                     ///< height over all
  float nose;                     ///< height of the bonnet at the nose
  float tail;                     ///< height of the deck at the tail
  float screen_base, screen_top;  ///< x of the windscreen
  float rear_top, rear_base;      ///< x of the rear window
  float wheel_radius;
  float front_axle, rear_axle;  ///< x
  bool has_rear_windows;        ///< else the sides behind the front doors are of sheet metal
};

const VehicleShape& ShapeOf(VehicleKind kind);

/// Returns half of the body's width at `x`: a superellipse in plan.
float HalfWidth(const VehicleShape& shape, float x);

/// The material and tint of a cell of a grid.
struct Skin {
  MaterialId material;
  Rgba tint{1, 1, 1, 1};
};

/// Adds a grid of points, rows of equal length, as smooth-shaded quads. `skin(i, j)` returns the
/// skin of the quad between rows i, i + 1 and columns j, j + 1. Faces look along (row direction) x
/// (column direction). A grid whose last row repeats the first one is smooth there too.
void AddGrid(MeshBuilder& b, const std::vector<std::vector<Vector3f>>& rows,
             const std::function<Skin(size_t i, size_t j)>& skin);

/// Adds the body below the windows with wheel arches, lamps, grille, bumpers and door seams.
void AddBody(MeshBuilder& b, const VehicleShape& shape);

}  // namespace orb360::town
