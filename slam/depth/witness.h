#pragma once

#include "slam/depth/depth_view.h"
#include "slam/depth/tested_row.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

/// A source view of a comparison; `witness_from_view` transforms the points into it. Two ranges
/// agree up to `tolerance_errors` expected errors plus `tolerance_share` of the range.
struct Witness {
  const DepthView* view;
  Rigid3 witness_from_view;
  double tolerance_errors;
  double tolerance_share;
};

/// Adds what a source view sees in the direction of each point. The same surface supports the
/// point, a nearer one hides it, and a farther one, also in the eight pixels around, contradicts
/// it. Between pixels 1 / range is interpolated linearly, which is nearly exact on planes, where
/// the four pixels around see one surface. Otherwise the nearest pixel is used.
void HearWitness(const Witness& witness, TestedRow* points);

}  // namespace orb360
