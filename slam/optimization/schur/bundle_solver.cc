#include "slam/optimization/schur/bundle_solver.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "slam/optimization/schur/block_cholesky.h"
#include "slam/optimization/schur/bundle_evaluator.h"
#include "slam/optimization/schur/levenberg_marquardt.h"
#include "slam/optimization/schur/schur_complement.h"

namespace orb360 {
namespace {

// A bundle as a Problem of MinimizeLevenbergMarquardt.
class BundleMinimization {
 public:
  BundleMinimization(BundleLoss loss, const BundleProblem& problem)
      : evaluator_(loss, problem),
        structure_(evaluator_.num_free_poses(), evaluator_.pairs(), MaxPoses(problem),
                   evaluator_.pose_pairs()),
        cholesky_(structure_) {
    for (const Rigid3& pose : problem.world_from_camera) {
      state_.camera_from_world.push_back(pose.Inverse());
    }
    state_.points = problem.points;
  }

  double Cost() const { return evaluator_.Cost(state_); }
  void Linearize() { evaluator_.Linearize(state_, &equations_); }

  std::optional<double> ComputeCandidate(double radius) {
    const PosePointPairs& pairs = evaluator_.pairs();
    if (!EliminatePoints(equations_, pairs, structure_, radius, &system_)) return std::nullopt;
    if (!cholesky_.Factor(system_.blocks)) return std::nullopt;
    const std::vector<PaddedVector> solution = cholesky_.Solve(system_.rhs);
    step_.poses.assign(solution.begin(), solution.begin() + evaluator_.num_free_poses());

    // Where (H + D) d = -g, the linear model's cost decreases by (D d - g) d / 2.
    double predicted = 0;
    const auto add_decrease = [&](const auto& d, const auto& gradient, const auto& diagonal) {
      predicted +=
          0.5 * (LevenbergMarquardtDamping(diagonal, radius).cwiseProduct(d) - gradient).dot(d);
    };
    for (size_t i = 0; i < step_.poses.size(); ++i) {
      add_decrease(step_.poses[i].head<kPoseSize>(), equations_.pose_gradient[i].head<kPoseSize>(),
                   Eigen::Matrix<double, kPoseSize, 1>(equations_.pose_hessian[i].diagonal()));
    }
    step_.points.resize(state_.points.size());
    for (size_t p = 0; p < step_.points.size(); ++p) {
      step_.points[p] = system_.BackSubstitute(pairs, structure_, p, solution);
      add_decrease(step_.points[p], equations_.point_gradient[p],
                   Eigen::Vector3d(equations_.point_hessian[p].diagonal()));
    }
    if (!std::isfinite(predicted) || predicted <= 0) return std::nullopt;
    candidate_ = evaluator_.Plus(state_, step_);
    return predicted;
  }

  double CandidateCost() const { return evaluator_.Cost(candidate_); }
  void AcceptCandidate() { std::swap(state_, candidate_); }

  const BundleState& state() const { return state_; }

 private:
  // Where there are fewer points than poses, as in a long shot that follows a few tracks, all
  // points are kept and the poses are eliminated first: the elimination of a point would link all
  // poses that see it.
  static size_t MaxPoses(const BundleProblem& problem) {
    return problem.points.size() < problem.world_from_camera.size()
               ? 0
               : ReducedCameraStructure::kMaxPoses;
  }

  BundleEvaluator evaluator_;
  ReducedCameraStructure structure_;
  BlockCholesky<kPoseSize> cholesky_;
  NormalEquations equations_;
  ReducedCameraSystem system_;
  BundleState state_;
  BundleState candidate_;
  BundleStep step_;
};

}  // namespace

SolverReport SolveBundleSchur(const BundleOptions& options, BundleProblem* problem) {
  BundleMinimization minimization(options.loss, *problem);
  const SolverReport report = MinimizeLevenbergMarquardt(
      {.max_iterations = options.max_iterations, .function_tolerance = options.function_tolerance},
      &minimization);
  if (!report.usable) return report;
  const BundleState& state = minimization.state();
  for (size_t i = 0; i < state.camera_from_world.size(); ++i) {
    if (problem->pose_fixed[i]) continue;
    problem->world_from_camera[i] = state.camera_from_world[i].Inverse();
  }
  problem->points = state.points;
  return report;
}

}  // namespace orb360
