#pragma once

#include "slam/optimization/bundle_adjustment.h"

namespace orb360 {

/// SolveBundle by the own solver: Levenberg-Marquardt steps on the reduced camera system, which is
/// factored by blocks. docs/concepts/bundle_adjustment.md derives it.
SolverReport SolveBundleSchur(const BundleOptions& options, BundleProblem* problem);

}  // namespace orb360
