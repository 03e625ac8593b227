#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// How far a tile of the ground is shifted from one bird's-eye view to the other, along one axis.
struct TileShift {
  Eigen::Vector2d place;  // of its centre relative to the point half-way, heights: along, across
  double shift;           // cells
  /// Its change with the distance between the lenses, cells per height.
  double per_lens_distance = 0;
};

/// The shift at the point half-way between the cameras.
struct ShiftBelow {
  double shift;              // cells
  Eigen::Vector2d gradient;  // along and across, cells per height
  double sigma;              // standard deviation of the shift, cells
  double gradient_sigma;     // and of its gradient along, cells per height
  double per_lens_distance;  // change of the shift with the distance assumed, cells per height
  int num_tiles;
};

/// Fits the shifts of the tiles by a polynomial of their place, because roads are cambered and bend
/// over hills, and leaves out tiles that do not agree: what moves, or stands on the ground. What
/// the distance between the lenses (heights of the camera) has done to the shifts is undone. Empty
/// where fewer than `min_tiles` agree.
std::optional<ShiftBelow> FitShifts(std::vector<TileShift> tiles, double lens_distance,
                                    int min_tiles);

/// Fits the shifts by the same polynomial and the distance between the lenses. Sigma is 0 where the
/// tiles do not tell it: all of them, or none, pass from one lens to the other.
LensDistance FitLensDistance(std::vector<TileShift> tiles, int min_tiles);

}  // namespace orb360
