#include "slam/optimization/bundle_adjustment.h"

#include <limits>

#include "nn/base/check.h"
#include "slam/optimization/bearing_residual.h"
#include "slam/optimization/bundle_solvers.h"

namespace orb360 {

BundleReport SolveBundle(const BundleOptions& options, BundleProblem* problem) {
  ORB360_CHECK(problem->pose_fixed.size() == problem->world_from_camera.size());
  constexpr size_t kFew = 100;  // the dense system of the poses takes 3 MB and few milliseconds
  return problem->world_from_camera.size() <= kFew ? SolveBundleDense(options, problem)
                                                   : SolveBundleSparse(options, problem);
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
