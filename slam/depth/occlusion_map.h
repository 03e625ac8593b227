#pragma once

#include <vector>

#include "slam/depth/depth_view.h"

namespace orb360 {

struct OcclusionMapOptions {
  /// Largest expected error of ln(range) of the pixels that count as surfaces.
  double max_error = 0.03;
  /// Side of the map's cells, pixels of the reference view.
  int cell = 4;
  /// Least number of cells, of one and the eight around it, in which a surface was seen.
  int min_cells = 5;
};

/// The surfaces that a source view sees, in the directions of a reference view: beyond them the
/// reference view cannot see anything.
class OcclusionMap {
 public:
  /// The views have images of the same size. Near borders of surfaces nothing is claimed: the
  /// farthest surface counts of those in a cell and the eight around it.
  OcclusionMap(const DepthView& source, const DepthView& reference,
               const OcclusionMapOptions& options = {});

  /// Returns the range at which a surface ends the ray through a pixel of the reference view, world
  /// units; infinite where none was seen.
  float RangeAt(int row, int column) const {
    return ranges_[static_cast<size_t>(row / cell_ * width_ + column / cell_)];
  }

 private:
  int cell_;
  int width_;   // cells
  int height_;  // cells
  std::vector<float> ranges_;
};

}  // namespace orb360
