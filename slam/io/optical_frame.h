#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Rotation from the optical camera frame of files (x right, y down, z forward) to the camera frame
/// of memory (-X forward, +Y right, +Z up).
inline Eigen::Quaterniond CameraFromOptical() {
  Eigen::Matrix3d columns;
  columns.col(0) = Eigen::Vector3d::UnitY();   // right
  columns.col(1) = -Eigen::Vector3d::UnitZ();  // down
  columns.col(2) = -Eigen::Vector3d::UnitX();  // forward
  return Eigen::Quaterniond(columns);
}

/// Returns the pose of the optical camera frame for that of the camera frame of memory.
inline Rigid3 WorldFromOptical(const Rigid3& world_from_camera) {
  return {(world_from_camera.rotation * CameraFromOptical()).normalized(),
          world_from_camera.translation};
}

}  // namespace orb360
