#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {

/// Rigid transform. Named `target_from_source`: p_target = target_from_source * p_source, and
/// a_from_c = a_from_b * b_from_c.
struct Rigid3 {
  /// Unit quaternion of target_from_source.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  /// Origin of the source frame in the target frame.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// Transforms a point.
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  /// Composes two transforms. The quaternion of the product is normalized, so that chains of any
  /// length remain rotations.
  Rigid3 operator*(const Rigid3& other) const {
    return {(rotation * other.rotation).normalized(), *this * other.translation};
  }
  /// Returns source_from_target.
  Rigid3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
};

/// Similarity transform p_target = scale * (rotation * p_source) + translation, scale > 0.
struct Similarity3 {
  /// Number of the target's units of length in one unit of the source.
  double scale = 1.0;
  /// Unit quaternion of target_from_source.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  /// Origin of the source frame in the target frame, in the target's unit of length.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// Transforms a point.
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    return scale * (rotation * p) + translation;
  }
  /// Composes two transforms. The quaternion of the product is normalized.
  Similarity3 operator*(const Similarity3& other) const {
    return {scale * other.scale, (rotation * other.rotation).normalized(),
            *this * other.translation};
  }
  /// Returns source_from_target.
  Similarity3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {1.0 / scale, inverse, -(inverse * translation) / scale};
  }
};

/// Returns the same transform with scale 1.
inline Similarity3 ToSimilarity(const Rigid3& transform) {
  return {1.0, transform.rotation, transform.translation};
}

/// Returns the pose of a camera after its world was moved and scaled: target_from_camera. The
/// camera's axes stay, and its unit of length follows the world's.
inline Rigid3 TransformPose(const Similarity3& target_from_world, const Rigid3& world_from_camera) {
  return {(target_from_world.rotation * world_from_camera.rotation).normalized(),
          target_from_world * world_from_camera.translation};
}

}  // namespace orb360
