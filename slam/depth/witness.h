#pragma once

#include "slam/depth/depth_view.h"
#include "slam/depth/tested_row.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

/// How another keyframe takes part in a comparison: `witness_from_view` brings the points to it.
/// Two ranges agree up to `tolerance_errors` expected errors and `tolerance_share` of the range.
struct Witness {
  const DepthView* view;
  Rigid3 witness_from_view;
  double tolerance_errors;
  double tolerance_share;
};

/// Adds what a witness sees in the direction of each point: the same surface supports it, something
/// nearer hides it, and something farther away, here and in the eight pixels around, conflicts with
/// it. Ranges between pixels are linear in 1 / range, nearly exact on planes, where the four
/// around see one surface; otherwise that of the nearest pixel counts.
void HearWitness(const Witness& witness, TestedRow* points);

}  // namespace orb360
