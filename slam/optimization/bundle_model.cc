#include "slam/optimization/bundle_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/geometry/so3.h"

namespace orb360 {
namespace {

std::vector<Eigen::Matrix3d> RotationsOf(const BundleEstimate& estimate) {
  std::vector<Eigen::Matrix3d> rotations;
  rotations.reserve(estimate.camera_from_world.size());
  for (const Rigid3& pose : estimate.camera_from_world) {
    rotations.push_back(pose.rotation.toRotationMatrix());
  }
  return rotations;
}

}  // namespace

BundleModel::BundleModel(const BundleOptions& options, const BundleProblem& problem)
    : first_term_(problem.points.size() + 1), direction_loss_(MakeBearingLoss(options.loss)) {
  for (const uint8_t is_fixed : problem.pose_fixed)
    moving_.push_back(is_fixed ? -1 : num_moving_++);
  for (const auto& o : problem.observations) directions_.emplace_back(o.bearing, o.sigma);
  for (const auto& h : problem.heights) heights_.emplace_back(h.normal, h.height, h.sigma);
  for (const auto& r : problem.ranges) ranges_.emplace_back(r.range, r.sigma);
  // Terms by point, by counting; those of a point stay in their order.
  const auto for_each_term = [&problem](const auto& take) {
    int index = 0;
    for (const auto& o : problem.observations)
      take(o.point, Term{Term::kDirection, o.pose, index++});
    index = 0;
    for (const auto& h : problem.heights) take(h.point, Term{Term::kHeight, h.pose, index++});
    index = 0;
    for (const auto& r : problem.ranges) take(r.point, Term{Term::kRange, r.pose, index++});
  };
  for_each_term([this](int point, const Term&) { ++first_term_[static_cast<size_t>(point) + 1]; });
  for (size_t p = 0; p < problem.points.size(); ++p) first_term_[p + 1] += first_term_[p];
  terms_.resize(first_term_.back());
  std::vector<size_t> next = first_term_;
  for_each_term([&](int point, const Term& term) { terms_[next[point]++] = term; });
}

Eigen::Vector2d BundleModel::Residual(const Term& term, const Eigen::Vector3d& seen,
                                      PointJacobian* jacobian) const {
  switch (term.kind) {
    case Term::kDirection:
      return directions_[term.index](seen, jacobian);
    case Term::kHeight:
      return heights_[term.index](seen, jacobian);
    case Term::kRange:
      return ranges_[term.index](seen, jacobian);
  }
  return {};
}

template <bool kWithDerivatives, typename Take>
double BundleModel::ForEachTerm(const BundleEstimate& estimate,
                                const std::vector<Eigen::Matrix3d>& rotations, size_t point,
                                const Take& take) const {
  double cost = 0;
  for (size_t t = first_term_[point]; t < first_term_[point + 1]; ++t) {
    const Term& term = terms_[t];
    const Eigen::Vector3d seen = rotations[term.pose] * estimate.points[point] +
                                 estimate.camera_from_world[term.pose].translation;
    PointJacobian jacobian;
    const Eigen::Vector2d residual = Residual(term, seen, kWithDerivatives ? &jacobian : nullptr);
    const double squared = residual.squaredNorm();
    if (!std::isfinite(squared)) return std::numeric_limits<double>::infinity();
    // A robust loss counts like a weight that is its slope (all of them bend downward).
    double loss[3] = {squared, 1, 0};
    if (term.kind == Term::kDirection) direction_loss_->Evaluate(squared, loss);
    if (term.kind == Term::kRange) range_loss_.Evaluate(squared, loss);
    cost += 0.5 * loss[0];
    if constexpr (kWithDerivatives) {
      const double weight = std::sqrt(loss[1]);
      take(term.pose, seen, weight * residual, weight * jacobian);
    }
  }
  return cost;
}

double BundleModel::Cost(const BundleEstimate& estimate) const {
  const std::vector<Eigen::Matrix3d> rotations = RotationsOf(estimate);
  double cost = 0;
  for (size_t p = 0; p < estimate.points.size(); ++p) {
    cost += ForEachTerm<false>(estimate, rotations, p, nullptr);
  }
  return cost;
}

NormalEquations BundleModel::Linearize(const BundleEstimate& estimate) const {
  const std::vector<Eigen::Matrix3d> rotations = RotationsOf(estimate);
  const size_t num_points = estimate.points.size();
  NormalEquations equations;
  equations.poses.assign(num_moving_, Matrix6::Zero());
  equations.pose_gradients.assign(num_moving_, Vector6::Zero());
  equations.points.assign(num_points, Eigen::Matrix3d::Zero());
  equations.point_gradients.assign(num_points, Eigen::Vector3d::Zero());
  equations.links.reserve(terms_.size());
  for (size_t p = 0; p < num_points; ++p) {
    const size_t first = equations.links.size();
    equations.first_link.push_back(first);
    ForEachTerm<true>(estimate, rotations, p,
                      [&](int pose, const Eigen::Vector3d& seen, const Eigen::Vector2d& residual,
                          const PointJacobian& by_seen) {
                        const PointJacobian by_point = by_seen * rotations[pose];
                        equations.points[p] += by_point.transpose() * by_point;
                        equations.point_gradients[p] += by_point.transpose() * residual;
                        const int moving = moving_[pose];
                        if (moving < 0) return;
                        Eigen::Matrix<double, 2, 6> by_pose;
                        by_pose << -by_seen * Skew(seen), by_seen;
                        equations.poses[moving] += by_pose.transpose() * by_pose;
                        equations.pose_gradients[moving] += by_pose.transpose() * residual;
                        const auto link = std::find_if(
                            equations.links.begin() + static_cast<std::ptrdiff_t>(first),
                            equations.links.end(),
                            [&](const BundleLink& l) { return l.pose == moving; });
                        if (link != equations.links.end()) {
                          link->block += by_pose.transpose() * by_point;
                        } else {
                          equations.links.push_back({moving, by_pose.transpose() * by_point});
                        }
                      });
  }
  equations.first_link.push_back(equations.links.size());
  return equations;
}

BundleEstimate BundleModel::Moved(const BundleEstimate& estimate, const BundleStep& step) const {
  BundleEstimate moved = estimate;
  for (size_t i = 0; i < moving_.size(); ++i) {
    if (moving_[i] < 0) continue;
    const Vector6& d = step.poses[moving_[i]];
    moved.camera_from_world[i] =
        Rigid3{ExpSo3(d.head<3>()), d.tail<3>()} * moved.camera_from_world[i];
  }
  for (size_t p = 0; p < moved.points.size(); ++p) moved.points[p] += step.points[p];
  return moved;
}

}  // namespace orb360
