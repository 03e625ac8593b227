#include "slam/optimization/pose_refinement.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "slam/geometry/cluster_weights.h"
#include "slam/optimization/bearing_residual.h"

namespace orb360 {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Basis = Eigen::Matrix<double, 3, 2>;

constexpr int kRounds = 4;
constexpr int kIterationsPerRound = 6;
constexpr int kMinInliers = 3;

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0;
};

// Half of Huber's loss of a squared residual; it is linear beyond the bound.
double HuberCost(double squared, double bound = kChiSquared95) {
  return squared <= bound ? 0.5 * squared : std::sqrt(bound) * std::sqrt(squared) - 0.5 * bound;
}

std::vector<Eigen::Vector3d> BearingsOf(std::span<const PoseObservation> observations) {
  std::vector<Eigen::Vector3d> bearings;
  bearings.reserve(observations.size());
  for (const PoseObservation& o : observations) bearings.push_back(o.bearing);
  return bearings;
}

class Problem {
 public:
  Problem(std::span<const PoseObservation> observations, const std::optional<PositionPrior>& prior)
      : observations_(observations), prior_(prior), clusters_(BearingsOf(observations)) {
    bases_.reserve(observations.size());
    for (const PoseObservation& o : observations) {
      bases_.push_back(TangentBasis(o.bearing) / o.sigma);
    }
  }

  /// Makes the active observations take part in the cost, and no others.
  void SetActive(std::span<const uint8_t> active) {
    weights_ = clusters_.Weights(active);
    for (size_t i = 0; i < weights_.size(); ++i) {
      if (!active[i]) weights_[i] = 0;
    }
  }

  double EffectiveCount(std::span<const uint8_t> active) const {
    return clusters_.EffectiveCount(active);
  }

  // Perturbation: camera_from_world <- exp(translation, rotation) * camera_from_world.
  NormalEquations Linearize(const Rigid3& camera_from_world) const {
    NormalEquations equations;
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (weights_[i] == 0) continue;
      const Eigen::Vector3d p = camera_from_world * observations_[i].point;
      Eigen::Matrix<double, 2, 3> point_jacobian;
      const Eigen::Vector2d residual = BearingResidual(p, bases_[i], &point_jacobian);
      const double squared = residual.squaredNorm();
      const double weight =
          weights_[i] * (squared <= kChiSquared95 ? 1.0 : std::sqrt(kChiSquared95 / squared));
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian.leftCols<3>() = point_jacobian;
      jacobian.rightCols<3>() = -point_jacobian * Skew(p);
      equations.hessian.noalias() += weight * jacobian.transpose() * jacobian;
      equations.gradient.noalias() += weight * jacobian.transpose() * residual;
      equations.cost += weights_[i] * HuberCost(squared);
    }
    if (prior_) LinearizePrior(camera_from_world, &equations);
    return equations;
  }

  double Cost(const Rigid3& camera_from_world) const {
    double cost = 0;
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (weights_[i] > 0) cost += weights_[i] * HuberCost(Squared(camera_from_world, i));
    }
    if (prior_) {
      cost += HuberCost(PriorResidual(camera_from_world).squaredNorm(), kPriorChiSquared95);
    }
    return cost;
  }

  double Squared(const Rigid3& camera_from_world, size_t i) const {
    return BearingResidual(camera_from_world * observations_[i].point, bases_[i], nullptr)
        .squaredNorm();
  }

  bool IsInlier(const Rigid3& camera_from_world, size_t i) const {
    const Eigen::Vector3d p = camera_from_world * observations_[i].point;
    return p.dot(observations_[i].bearing) > 0 &&
           BearingResidual(p, bases_[i], nullptr).squaredNorm() <= kChiSquared95;
  }

  size_t size() const { return observations_.size(); }

 private:
  Eigen::Vector3d PriorResidual(const Rigid3& camera_from_world) const {
    return prior_->ErrorOf(camera_from_world.Inverse().translation);
  }

  void LinearizePrior(const Rigid3& camera_from_world, NormalEquations* equations) const {
    const Eigen::Vector3d residual = PriorResidual(camera_from_world);
    const double squared = residual.squaredNorm();
    const double weight =
        squared <= kPriorChiSquared95 ? 1.0 : std::sqrt(kPriorChiSquared95 / squared);
    // A perturbation moves the camera's centre by -(world_from_camera rotation) * translation.
    const Eigen::Matrix3d jacobian =
        -prior_->sqrt_information * camera_from_world.rotation.conjugate().toRotationMatrix();
    equations->hessian.topLeftCorner<3, 3>() += weight * jacobian.transpose() * jacobian;
    equations->gradient.head<3>() += weight * jacobian.transpose() * residual;
    equations->cost += HuberCost(squared, kPriorChiSquared95);
  }

  std::span<const PoseObservation> observations_;
  std::optional<PositionPrior> prior_;
  ClusterWeights clusters_;
  std::vector<Basis> bases_;     // divided by sigma
  std::vector<double> weights_;  // 0: not active
};

Rigid3 Perturb(const Vector6d& delta, const Rigid3& camera_from_world) {
  return Rigid3{ExpSo3(delta.tail<3>()), delta.head<3>()} * camera_from_world;
}

Rigid3 Minimize(const Problem& problem, Rigid3 pose) {
  double damping = 1e-6;  // relative to the diagonal
  NormalEquations equations = problem.Linearize(pose);
  for (int iteration = 0; iteration < kIterationsPerRound; ++iteration) {
    Matrix6d damped = equations.hessian;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d delta = damped.ldlt().solve(-equations.gradient);
    if (!delta.allFinite()) break;
    const Rigid3 candidate = Perturb(delta, pose);
    const double cost = problem.Cost(candidate);
    if (cost <= equations.cost) {
      const bool converged = equations.cost - cost < 1e-6 * equations.cost;
      pose = candidate;
      damping = std::max(1e-9, 0.1 * damping);
      if (converged) break;
      equations = problem.Linearize(pose);
    } else {
      damping *= 100;
    }
  }
  return pose;
}

}  // namespace

RefinedPose RefinePose(const Rigid3& initial_world_from_camera,
                       std::span<const PoseObservation> observations,
                       const std::optional<PositionPrior>& prior) {
  Problem problem(observations, prior);
  RefinedPose result{
      initial_world_from_camera, std::vector<uint8_t>(problem.size(), 0), 0, 0, 0, 0};
  std::vector<uint8_t> active(problem.size(), 1);
  const double support_of_all = problem.EffectiveCount(active);
  Rigid3 pose = initial_world_from_camera.Inverse();
  int num_active = 0;
  for (int round = 0; round < kRounds; ++round) {
    problem.SetActive(active);
    pose = Minimize(problem, pose);
    num_active = 0;
    bool changed = false;
    for (size_t i = 0; i < problem.size(); ++i) {
      const uint8_t inlier = problem.IsInlier(pose, i);
      changed |= inlier != active[i];
      active[i] = inlier;
      num_active += inlier;
    }
    if (num_active < kMinInliers) return result;
    if (!changed) break;
  }
  double sum = 0;
  for (size_t i = 0; i < problem.size(); ++i) {
    if (active[i]) sum += problem.Squared(pose, i);
  }
  result.world_from_camera = pose.Inverse();
  result.inliers = std::move(active);
  result.num_inliers = num_active;
  result.support = problem.EffectiveCount(result.inliers);
  result.inlier_ratio = result.support / support_of_all;
  result.rms = std::sqrt(sum / (2.0 * num_active));
  return result;
}

}  // namespace orb360
