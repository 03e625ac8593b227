#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "slam/optimization/bundle_model.h"
#include "slam/optimization/bundle_solvers.h"

namespace orb360 {
namespace {

// Of the damping, as in Ceres: the trust region's radius, the least diagonal that is damped, and
// the least share of the predicted decrease with which a step is taken.
constexpr double kFirstRadius = 1e4;
constexpr double kMaxRadius = 1e16;
constexpr double kMinRadius = 1e-32;
constexpr double kMinDiagonal = 1e-6;
constexpr double kMinGain = 1e-3;

/// Marquardt's damping of a diagonal.
template <typename Vector>
Vector Damping(const Vector& diagonal, double radius) {
  return diagonal.cwiseMax(kMinDiagonal) / radius;
}

/// Of the lower triangle; what is above counts as zero.
Eigen::Matrix3d InverseOfLower(const Eigen::Matrix3d& l) {
  const double a = 1 / l(0, 0);
  const double b = 1 / l(1, 1);
  const double c = 1 / l(2, 2);
  const double low = -b * l(1, 0) * a;
  Eigen::Matrix3d inverse;
  inverse << a, 0, 0,  //
      low, b, 0,       //
      -c * (l(2, 0) * a + l(2, 1) * low), -c * l(2, 1) * b, c;
  return inverse;
}

/// One step towards the minimum. False where the damped equations are not positive definite to
/// rounding, or promise nothing: at the minimum.
bool Solve(const NormalEquations& equations, double radius, BundleStep* step) {
  const int num_moving = static_cast<int>(equations.poses.size());
  const auto block = [](int pose) { return static_cast<Eigen::Index>(6) * pose; };
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(block(num_moving), block(num_moving));
  Eigen::VectorXd sums(block(num_moving));
  for (int i = 0; i < num_moving; ++i) {
    system.block<6, 6>(block(i), block(i)) = equations.poses[i];
    system.diagonal().segment<6>(block(i)) +=
        Damping<Vector6>(equations.poses[i].diagonal(), radius);
    sums.segment<6>(block(i)) = -equations.pose_gradients[i];
  }
  // The points are eliminated: with L L^T the block of a point and Y = L^-1 W^T for each of its
  // links, the block of two poses loses Y_a^T Y_b.
  std::vector<Eigen::Matrix3d> inverses(equations.points.size());  // L^-1
  std::vector<Eigen::Matrix<double, 3, 6>> reduced(equations.links.size());
  std::vector<Eigen::Vector3d> reduced_sums(equations.points.size());
  for (size_t p = 0; p < equations.points.size(); ++p) {
    Eigen::Matrix3d damped = equations.points[p];
    damped.diagonal() += Damping<Eigen::Vector3d>(equations.points[p].diagonal(), radius);
    const Eigen::LLT<Eigen::Matrix3d> factor(damped);
    if (factor.info() != Eigen::Success) return false;
    inverses[p] = InverseOfLower(factor.matrixLLT());
    reduced_sums[p] = inverses[p] * equations.point_gradients[p];
    for (size_t a = equations.first_link[p]; a < equations.first_link[p + 1]; ++a) {
      const BundleLink& link = equations.links[a];
      reduced[a] = inverses[p] * link.block.transpose();
      sums.segment<6>(block(link.pose)) += reduced[a].transpose() * reduced_sums[p];
      for (size_t b = equations.first_link[p]; b <= a; ++b) {
        // Only the lower triangle is kept.
        const bool is_lower = link.pose >= equations.links[b].pose;
        const size_t row = is_lower ? a : b;
        const size_t column = is_lower ? b : a;
        system.block<6, 6>(block(equations.links[row].pose), block(equations.links[column].pose))
            .noalias() -= reduced[row].transpose() * reduced[column];
      }
    }
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(system);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd poses = factor.solve(sums);

  // With the gradient g and the damping D, the linear problem's cost falls by (D d - g) d / 2.
  step->predicted = 0;
  const auto predict = [&](const auto& d, const auto& gradient, const auto& damping) {
    step->predicted += 0.5 * (damping.cwiseProduct(d) - gradient).dot(d);
  };
  step->poses.resize(equations.poses.size());
  for (int i = 0; i < num_moving; ++i) {
    step->poses[i] = poses.segment<6>(block(i));
    predict(step->poses[i], equations.pose_gradients[i],
            Damping<Vector6>(equations.poses[i].diagonal(), radius));
  }
  step->points.resize(equations.points.size());
  for (size_t p = 0; p < equations.points.size(); ++p) {
    Eigen::Vector3d rest = -reduced_sums[p];
    for (size_t a = equations.first_link[p]; a < equations.first_link[p + 1]; ++a) {
      rest -= reduced[a] * step->poses[equations.links[a].pose];
    }
    step->points[p] = inverses[p].transpose() * rest;
    predict(step->points[p], equations.point_gradients[p],
            Damping<Eigen::Vector3d>(equations.points[p].diagonal(), radius));
  }
  return std::isfinite(step->predicted) && step->predicted > 0;
}

}  // namespace

BundleReport SolveBundleDense(const BundleOptions& options, BundleProblem* problem) {
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
  BundleStep step;
  int solved = 0;
  while (report.iterations < options.max_iterations && cost > 0) {
    ++report.iterations;
    if (!is_linearized) equations = bundle.Linearize(estimate);
    is_linearized = true;
    double gain = 0;
    bool has_converged = false;
    if (Solve(equations, radius, &step)) {
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

}  // namespace orb360
