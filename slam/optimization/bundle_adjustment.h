#pragma once

#include "slam/optimization/bundle_problem.h"
#include "slam/optimization/solver_report.h"
#include <orb360/slam/optimization/optimizer.h>

namespace orb360 {

/// The robust loss of the observations' residuals.
enum class BundleLoss {
  /// Huber's loss, linear from one sigma on. The errors of corners have heavier tails than a normal
  /// distribution, since a corner is not quite the same point from every side. With a loss that is
  /// quadratic up to the 95 % bound (2.4 sigmas), a few corners of roofs and trees that dozens of
  /// keyframes see decide how the scale drifts.
  kHuber,
  /// A bounded loss, which reaches 86 % of its limit at three sigmas. It is for poses that are
  /// nearly right and observations some of which are wrong altogether.
  kArctan,
};

struct BundleOptions {
  int max_iterations = 10;
  BundleLoss loss = BundleLoss::kHuber;
  /// The solver stops when an iteration changes the cost by less than this fraction.
  double function_tolerance = 1e-4;
  Optimizer optimizer = Optimizer::kSchur;
};

/// Minimizes the robust cost of tangent-plane residuals (bearing_residual.h; paper Eq. 11), heights
/// and ranges over all poses that are not fixed and all points, on one thread. The derivation is in
/// docs/concepts/bundle_adjustment.md.
/// Contract: indices are in range; every point is observed.
SolverReport SolveBundle(const BundleOptions& options, BundleProblem* problem);

/// Squared residual of an observation in sigmas; infinite for a point behind its bearing.
double SquaredResidual(const BundleProblem& problem, const BundleProblem::Observation& observation);

}  // namespace orb360
