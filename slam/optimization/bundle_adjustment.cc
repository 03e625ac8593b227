#include "slam/optimization/bundle_adjustment.h"

#include <limits>

#include "slam/optimization/bearing_residual.h"
#include "slam/optimization/ceres/bundle_solver.h"
#include "slam/optimization/schur/bundle_solver.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

SolverReport SolveBundle(const BundleOptions& options, BundleProblem* problem) {
  ORB360_CHECK(problem->pose_fixed.size() == problem->world_from_camera.size());
  return options.optimizer == Optimizer::kCeres ? SolveBundleCeres(options, problem)
                                                : SolveBundleSchur(options, problem);
}

double SquaredResidual(const BundleProblem& problem,
                       const BundleProblem::Observation& observation) {
  const Eigen::Vector3d point =
      problem.world_from_camera[observation.pose].Inverse() * problem.points[observation.point];
  if (!(point.dot(observation.bearing) > 0)) return std::numeric_limits<double>::infinity();
  return BearingResidual(point, TangentBasis(observation.bearing) / observation.sigma, nullptr)
      .squaredNorm();
}

}  // namespace orb360
