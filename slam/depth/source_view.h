#pragma once

#include "slam/depth/depth_view.h"
#include "slam/depth/tested_row.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A source view with which the points of a reference view are compared. `source_from_reference`
/// transforms the points into the camera frame of the source view. Two ranges agree if they differ
/// by at most `tolerance_errors` expected errors plus `relative_tolerance` times the range. A
/// source view whose own error along the normal is more than `max_error`, world units, supports
/// nothing: whatever a point's range is, it agrees with one that is hardly known, as that of the
/// sky.
struct SourceView {
  const DepthView* view;
  Rigid3 source_from_reference;
  double tolerance_errors;
  double relative_tolerance;
  float max_error;
};

/// Adds what a source view sees in the direction of each point. The same surface supports the
/// point, a nearer one hides it, and a farther one, also in the eight pixels around, contradicts
/// it. Between pixels 1 / range is interpolated linearly, which is nearly exact on planes, where
/// the four pixels around see one surface. Otherwise the nearest pixel is used.
void CompareWithSourceView(const SourceView& source, TestedRow* points);

}  // namespace orb360
