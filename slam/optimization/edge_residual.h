#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/optimization/pose_graph.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {

/// A similarity world_from_node with the logarithm of its scale. Its seven unknowns (w, d, l)
/// change it to (exp(w) * rotation, translation + d, log_scale + l).
struct SimilarityState {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
  double log_scale;

  explicit SimilarityState(const Similarity3& s)
      : rotation(s.rotation), translation(s.translation), log_scale(std::log(s.scale)) {}

  Similarity3 ToSimilarity() const {
    return {.scale = std::exp(log_scale), .rotation = rotation, .translation = translation};
  }
  void Add(const Eigen::Matrix<double, 7, 1>& step) {
    rotation = (ExpSo3(step.head<3>()) * rotation).normalized();
    translation += step.segment<3>(3);
    log_scale += step[6];
  }
};

/// The error of an edge of a pose graph (see SolvePoseGraph) times the root of its weight. Rows:
/// rotation (twice the vector part of its quaternion), translation, logarithm of the scale.
class EdgeResidual {
 public:
  using Vector = Eigen::Matrix<double, 7, 1>;
  using Jacobian = Eigen::Matrix<double, 7, 7>;

  EdgeResidual(const PoseGraph::Edge& edge, double unit)
      : second_from_first_(edge.first_from_second.Inverse()),
        log_scale_(std::log(second_from_first_.scale)),
        root_weight_(std::sqrt(edge.weight)),
        unit_(unit) {}

  /// The Jacobians are by the unknowns of SimilarityState; both or none are null.
  Vector operator()(const SimilarityState& first, const SimilarityState& second, Jacobian* by_first,
                    Jacobian* by_second) const {
    const Eigen::Quaterniond measured_from_world =
        second_from_first_.rotation * first.rotation.conjugate();
    const Eigen::Quaterniond rotation = measured_from_world * second.rotation;
    const Eigen::Matrix3d matrix = measured_from_world.toRotationMatrix();
    const double scale = second_from_first_.scale * std::exp(-first.log_scale);
    const Eigen::Vector3d between = second.translation - first.translation;
    const double rotation_sign = rotation.w() < 0 ? -1.0 : 1.0;  // q and -q are the same rotation
    const double length_weight = root_weight_ / unit_;

    Vector error;
    error.head<3>() = (2.0 * rotation_sign * root_weight_) * rotation.vec();
    error.segment<3>(3) =
        length_weight * (scale * (matrix * between) + second_from_first_.translation);
    error[6] = root_weight_ * (log_scale_ + second.log_scale - first.log_scale);
    if (by_first == nullptr) return error;

    // A change of the second rotation by exp(w) changes the error's quaternion q to exp(M w) q, M
    // the matrix above, and its vector part by (q_w I - [q_v]x) M w / 2. A change of the first
    // rotation does the opposite, and rotates `between` by -w.
    const Eigen::Matrix3d by_rotation =
        (rotation_sign * root_weight_) *
        (rotation.w() * Eigen::Matrix3d::Identity() - Skew(rotation.vec())) * matrix;
    const Eigen::Matrix3d by_translation = (length_weight * scale) * matrix;
    by_second->setZero();
    by_second->topLeftCorner<3, 3>() = by_rotation;
    by_second->block<3, 3>(3, 3) = by_translation;
    (*by_second)(6, 6) = root_weight_;
    *by_first = -*by_second;
    by_first->block<3, 3>(3, 0) = by_translation * Skew(between);
    by_first->block<3, 1>(3, 6) = -(by_translation * between);
    return error;
  }

 private:
  Similarity3 second_from_first_;
  double log_scale_;
  double root_weight_;
  double unit_;
};

}  // namespace orb360
