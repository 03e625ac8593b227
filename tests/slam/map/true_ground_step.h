#pragma once

#include <orb360/slam/map/map.h>

namespace orb360 {

/// The step between two poses (world_from_camera) over ground with the normal +Z, as images of the
/// ground would show it without an error.
inline GroundStepFrom TrueGroundStep(KeyframeId from, const Rigid3& pose1, const Rigid3& pose2,
                                     double camera_height, double sigma = 0.002) {
  const Eigen::Vector3d step = pose2.translation - pose1.translation;
  const Eigen::Vector3d below =
      0.5 * (pose1.translation + pose2.translation) - camera_height * Eigen::Vector3d::UnitZ();
  const auto in_frame = [](const Rigid3& pose, const Eigen::Vector3d& direction) {
    return Eigen::Vector3d(pose.rotation.conjugate() * direction);
  };
  return {.keyframe = from,
          .ratio = step.norm() / camera_height,
          .sigma = sigma,
          .point1 = pose1.Inverse() * below / camera_height,
          .point2 = pose2.Inverse() * below / camera_height,
          .direction1 = in_frame(pose1, step.normalized()),
          .direction2 = in_frame(pose2, step.normalized()),
          .turn_sigma = 0.001,
          .up = in_frame(pose2, Eigen::Vector3d::UnitZ())};
}

}  // namespace orb360
