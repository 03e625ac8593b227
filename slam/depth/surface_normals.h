#pragma once

#include "slam/depth/depth_view.h"
#include "slam/depth/tested_row.h"

namespace orb360 {

/// Fits a plane to the surface around each point: to the ranges of 5 x 5 pixels, with less weight
/// for those that differ much from the point's own. On a plane 1 / range is linear in the bearing.
void FitNormals(const DepthView& view, TestedRow* points);

}  // namespace orb360
