#include "slam/optimization/ceres/bundle_solver.h"

#include <array>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include <ceres/ceres.h>

#include "slam/optimization/bundle_loss.h"
#include "slam/optimization/ceres/point_cost.h"
#include "slam/optimization/ceres/shared_point_cost.h"
#include "slam/optimization/ceres/solver_options.h"

namespace orb360 {
namespace {

std::unique_ptr<ceres::LossFunction> MakeCeresLoss(const RobustLoss& loss) {
  switch (loss.kind) {
    case RobustLoss::kTrivial:
      break;
    case RobustLoss::kHuber:
      return std::make_unique<ceres::HuberLoss>(loss.scale);
    case RobustLoss::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(loss.scale);
    case RobustLoss::kArctan:
      return std::make_unique<ceres::ArctanLoss>(loss.scale);
  }
  return nullptr;
}

// A bundle with parameters as PointCost has them, as a problem of Ceres. It cannot be copied, since
// the problem refers to the other members.
class CeresBundle {
 public:
  CeresBundle(BundleLoss loss, const BundleProblem& bundle)
      : direction_loss_(MakeCeresLoss(DirectionLoss(loss))),
        height_loss_(MakeCeresLoss(HeightLoss())),
        range_loss_(MakeCeresLoss(RangeLoss())),
        shared_point_loss_(MakeCeresLoss(SharedPointLoss())),
        poses_(bundle.world_from_camera.size()),
        points_(bundle.points),
        ordering_(std::make_shared<ceres::ParameterBlockOrdering>()),
        problem_(ProblemOptions()) {
    for (size_t i = 0; i < poses_.size(); ++i) {
      const Rigid3& world_from_camera = bundle.world_from_camera[i];
      Eigen::Map<Eigen::Quaterniond>(poses_[i].data()) = world_from_camera.rotation.conjugate();
      Eigen::Map<Eigen::Vector3d>(poses_[i].data() + 4) = world_from_camera.translation;
      problem_.AddParameterBlock(poses_[i].data(), 7, &manifold_);
      if (bundle.pose_fixed[i]) problem_.SetParameterBlockConstant(poses_[i].data());
    }
    for (Eigen::Vector3d& point : points_) problem_.AddParameterBlock(point.data(), 3);
    // The more numerous variables are eliminated. Those are the points, except where a long track
    // follows a few of them: their elimination would make the reduced system large and full. Poses
    // with a residual in common cannot be eliminated one by one.
    const bool eliminates_points = points_.size() >= poses_.size() || !bundle.shared_points.empty();
    for (auto& pose : poses_) ordering_->AddElementToGroup(pose.data(), eliminates_points ? 1 : 0);
    for (Eigen::Vector3d& point : points_) {
      ordering_->AddElementToGroup(point.data(), eliminates_points ? 0 : 1);
    }
    for (const BundleProblem::Observation& o : bundle.observations) {
      directions_.emplace_back(DirectionResidual(o.bearing, o.sigma));
      AddBlock(&directions_.back(), direction_loss_.get(), o.pose, o.point);
    }
    for (const BundleProblem::Height& h : bundle.heights) {
      heights_.emplace_back(HeightResidual(h.normal, h.height, h.sigma));
      AddBlock(&heights_.back(), height_loss_.get(), h.pose, h.point);
    }
    for (const BundleProblem::Range& r : bundle.ranges) {
      ranges_.emplace_back(RangeResidual(r.range, r.sigma));
      AddBlock(&ranges_.back(), range_loss_.get(), r.pose, r.point);
    }
    for (const BundleProblem::SharedPoint& shared : bundle.shared_points) {
      shared_points_.emplace_back(shared);
      problem_.AddResidualBlock(&shared_points_.back(), shared_point_loss_.get(),
                                poses_[shared.pose1].data(), poses_[shared.pose2].data());
    }
  }
  CeresBundle(const CeresBundle&) = delete;
  CeresBundle& operator=(const CeresBundle&) = delete;

  SolverReport Solve(const BundleOptions& options) {
    ceres::Solver::Options solver_options = DeterministicSolverOptions();
    solver_options.linear_solver_type = ceres::SPARSE_SCHUR;
    solver_options.linear_solver_ordering = ordering_;
    solver_options.max_num_iterations = options.max_iterations;
    solver_options.function_tolerance = options.function_tolerance;
    // The relative change of the cost alone decides, as BundleOptions says.
    solver_options.gradient_tolerance = 0;
    solver_options.parameter_tolerance = 0;
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options, &problem_, &summary);
    return ToReport(summary);
  }

  Rigid3 WorldFromCamera(size_t pose) const {
    return {Eigen::Map<const Eigen::Quaterniond>(poses_[pose].data()).normalized().conjugate(),
            Eigen::Map<const Eigen::Vector3d>(poses_[pose].data() + 4)};
  }
  const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  void AddBlock(ceres::CostFunction* cost, ceres::LossFunction* loss, int pose, int point) {
    problem_.AddResidualBlock(cost, loss, poses_[pose].data(), points_[point].data());
  }

  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>> manifold_;
  std::unique_ptr<ceres::LossFunction> direction_loss_;
  std::unique_ptr<ceres::LossFunction> height_loss_;
  std::unique_ptr<ceres::LossFunction> range_loss_;
  std::unique_ptr<ceres::LossFunction> shared_point_loss_;
  std::vector<std::array<double, 7>> poses_;
  std::vector<Eigen::Vector3d> points_;
  std::deque<PointCost<DirectionResidual>> directions_;  // cost functions cannot move
  std::deque<PointCost<HeightResidual>> heights_;
  std::deque<PointCost<RangeResidual>> ranges_;
  std::deque<SharedPointCost> shared_points_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_;
  ceres::Problem problem_;
};

}  // namespace

SolverReport SolveBundleCeres(const BundleOptions& options, BundleProblem* problem) {
  CeresBundle bundle(options.loss, *problem);
  const SolverReport report = bundle.Solve(options);
  if (!report.usable) return report;
  for (size_t i = 0; i < problem->world_from_camera.size(); ++i) {
    if (!problem->pose_fixed[i]) problem->world_from_camera[i] = bundle.WorldFromCamera(i);
  }
  problem->points = bundle.points();
  return report;
}

}  // namespace orb360
