#pragma once

#include "slam/depth/depth_view.h"
#include "slam/depth/tested_row.h"

namespace orb360 {

/// The surface around each point as a plane: fitted to the ranges of 5 x 5 pixels around it, those
/// that differ much from its own counting less. On a plane 1 / range is linear in the bearing.
void FitNormals(const DepthView& view, TestedRow* points);

}  // namespace orb360
