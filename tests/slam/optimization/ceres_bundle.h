#pragma once

#include <array>
#include <deque>
#include <memory>

#include <ceres/ceres.h>

#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/bundle_loss.h"
#include "tests/slam/optimization/point_cost.h"

namespace orb360 {

inline std::unique_ptr<ceres::LossFunction> MakeCeresLoss(const RobustLoss& loss) {
  if (loss.kind == RobustLoss::kHuber) return std::make_unique<ceres::HuberLoss>(loss.scale);
  if (loss.kind == RobustLoss::kCauchy) return std::make_unique<ceres::CauchyLoss>(loss.scale);
  if (loss.kind == RobustLoss::kArctan) return std::make_unique<ceres::ArctanLoss>(loss.scale);
  return nullptr;
}

/// SolveBundle by Ceres, as independent truth.
inline SolverReport SolveBundleByCeres(const BundleOptions& options, BundleProblem* bundle) {
  // As PointCost has them.
  std::vector<std::array<double, 7>> poses(bundle->world_from_camera.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    const Rigid3& world_from_camera = bundle->world_from_camera[i];
    Eigen::Map<Eigen::Quaterniond>(poses[i].data()) = world_from_camera.rotation.conjugate();
    Eigen::Map<Eigen::Vector3d>(poses[i].data() + 4) = world_from_camera.translation;
  }
  std::vector<Eigen::Vector3d> points = bundle->points;

  const std::unique_ptr<ceres::LossFunction> loss = MakeCeresLoss(DirectionLoss(options.loss));
  const std::unique_ptr<ceres::LossFunction> range_loss = MakeCeresLoss(RangeLoss());
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>> manifold;
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  std::deque<PointCost<DirectionResidual>> costs;  // cost functions cannot move
  std::deque<PointCost<HeightResidual>> height_costs;
  std::deque<PointCost<RangeResidual>> range_costs;
  ceres::Problem problem(problem_options);
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (size_t i = 0; i < poses.size(); ++i) {
    problem.AddParameterBlock(poses[i].data(), 7, &manifold);
    if (bundle->pose_fixed[i]) problem.SetParameterBlockConstant(poses[i].data());
    ordering->AddElementToGroup(poses[i].data(), 1);
  }
  for (Eigen::Vector3d& point : points) {
    problem.AddParameterBlock(point.data(), 3);
    ordering->AddElementToGroup(point.data(), 0);
  }
  for (const BundleProblem::Observation& o : bundle->observations) {
    costs.emplace_back(DirectionResidual(o.bearing, o.sigma));
    problem.AddResidualBlock(&costs.back(), loss.get(), poses[o.pose].data(),
                             points[o.point].data());
  }
  for (const BundleProblem::Height& h : bundle->heights) {
    height_costs.emplace_back(HeightResidual(h.normal, h.height, h.sigma));
    problem.AddResidualBlock(&height_costs.back(), nullptr, poses[h.pose].data(),
                             points[h.point].data());
  }
  for (const BundleProblem::Range& r : bundle->ranges) {
    range_costs.emplace_back(RangeResidual(r.range, r.sigma));
    problem.AddResidualBlock(&range_costs.back(), range_loss.get(), poses[r.pose].data(),
                             points[r.point].data());
  }

  ceres::Solver::Options solver_options;
  solver_options.linear_solver_type = ceres::SPARSE_SCHUR;
  if (ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::SUITE_SPARSE)) {
    solver_options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  } else {
    solver_options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  }
  solver_options.linear_solver_ordering = ordering;
  solver_options.max_num_iterations = options.max_iterations;
  solver_options.function_tolerance = options.function_tolerance;
  solver_options.num_threads = 1;
  solver_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);

  SolverReport report{summary.initial_cost, summary.final_cost,
                      static_cast<int>(summary.iterations.size()) - 1, summary.IsSolutionUsable()};
  if (!report.usable) return report;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (bundle->pose_fixed[i]) continue;
    bundle->world_from_camera[i] = {
        Eigen::Map<const Eigen::Quaterniond>(poses[i].data()).normalized().conjugate(),
        Eigen::Map<const Eigen::Vector3d>(poses[i].data() + 4)};
  }
  bundle->points = std::move(points);
  return report;
}

}  // namespace orb360
