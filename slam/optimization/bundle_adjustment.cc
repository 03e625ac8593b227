#include "slam/optimization/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "nn/base/check.h"
#include "slam/optimization/bearing_residual.h"
#include "slam/optimization/block_cholesky.h"
#include "slam/optimization/bundle_model.h"

namespace orb360 {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// As in Ceres: the trust region's radius, and the least share of the predicted decrease with which
// a step is taken.
constexpr double kFirstRadius = 1e4;
constexpr double kMaxRadius = 1e16;
constexpr double kMinRadius = 1e-32;
constexpr double kMinGain = 1e-3;

/// One step towards the minimum. False where the damped equations are not positive definite to
/// rounding, or promise nothing: at the minimum.
bool Solve(const NormalEquations& equations, const BundleModel& bundle, double radius,
           BlockCholesky* factor, ReducedEquations* reduced, BundleStep* step) {
  const BundleLinks& links = bundle.links();
  if (!EliminatePoints(equations, links, bundle.structure(), radius, reduced)) return false;
  if (!factor->Factor(reduced->blocks)) return false;
  const std::vector<PoseVector> rows = factor->Solve(reduced->sums);
  step->poses.assign(rows.begin(), rows.begin() + equations.poses.size());

  // With the gradient g and the damping D, the linear problem's cost falls by (D d - g) d / 2.
  step->predicted = 0;
  const auto predict = [&](const auto& d, const auto& gradient, const auto& diagonal) {
    step->predicted += 0.5 * (Damping(diagonal, radius).cwiseProduct(d) - gradient).dot(d);
  };
  for (size_t i = 0; i < equations.poses.size(); ++i) {
    predict(step->poses[i].head<6>(), equations.pose_gradients[i].head<6>(),
            Vector6(equations.poses[i].diagonal()));
  }
  step->points.resize(equations.points.size());
  for (size_t p = 0; p < step->points.size(); ++p) {
    step->points[p] = reduced->PointStep(links, bundle.structure(), p, rows);
    predict(step->points[p], equations.point_gradients[p],
            Eigen::Vector3d(equations.points[p].diagonal()));
  }
  return std::isfinite(step->predicted) && step->predicted > 0;
}

}  // namespace

BundleReport SolveBundle(const BundleOptions& options, BundleProblem* problem) {
  ORB360_CHECK(problem->pose_fixed.size() == problem->world_from_camera.size());
  const BundleModel bundle(options, *problem);
  BundleEstimate estimate;
  for (const Rigid3& pose : problem->world_from_camera) {
    estimate.camera_from_world.push_back(pose.Inverse());
  }
  estimate.points = problem->points;
  double cost = bundle.Cost(estimate);
  BundleReport report{cost, cost, 0, std::isfinite(cost)};
  if (!report.usable) return report;

  double radius = kFirstRadius;
  double shrinking = 2;
  bool is_linearized = false;
  NormalEquations equations;
  BlockCholesky factor(bundle.structure());
  ReducedEquations reduced;
  BundleStep step;
  int solved = 0;
  while (report.iterations < options.max_iterations && cost > 0) {
    ++report.iterations;
    if (!is_linearized) bundle.Linearize(estimate, &equations);
    is_linearized = true;
    double gain = 0;
    bool has_converged = false;
    if (Solve(equations, bundle, radius, &factor, &reduced, &step)) {
      ++solved;
      BundleEstimate moved = bundle.Moved(estimate, step);
      const double new_cost = bundle.Cost(moved);
      has_converged = std::abs(cost - new_cost) <= options.function_tolerance * cost;
      gain = (cost - new_cost) / step.predicted;
      if (gain > kMinGain) {
        estimate = std::move(moved);
        cost = new_cost;
        is_linearized = false;
      }
    }
    if (has_converged) break;
    // Nielsen's rule, as in Ceres.
    if (gain > kMinGain) {
      radius = std::min(kMaxRadius, radius / std::max(1.0 / 3.0, 1 - std::pow(2 * gain - 1, 3)));
      shrinking = 2;
    } else {
      radius /= shrinking;
      shrinking *= 2;
      if (radius < kMinRadius) break;
    }
  }
  report.usable = solved > 0 || report.iterations == 0;
  if (!report.usable) return report;
  report.final_cost = cost;
  for (size_t i = 0; i < estimate.camera_from_world.size(); ++i) {
    if (problem->pose_fixed[i]) continue;
    problem->world_from_camera[i] = estimate.camera_from_world[i].Inverse();
  }
  problem->points = std::move(estimate.points);
  return report;
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
