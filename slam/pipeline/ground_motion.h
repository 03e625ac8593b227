#pragma once

#include <optional>

#include <Eigen/Core>

#include "slam/optimization/pose_refinement.h"
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// The camera's motion over the ground at its newest keyframe, as the images of the ground show it
/// (GroundStepFrom), and how much it has changed lately.
struct GroundMotion {
  double timestamp = 0;  ///< Of the keyframe, seconds.
  Rigid3 world_from_camera;
  /// Frame of the keyframe's camera, world units per second.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  /// Variance of the logarithm of the speed, and of the direction's angle, for each second that
  /// passes.
  double speed_variance = 0;
  double angle_variance = 0;
};

/// Empty where the newest keyframe has no step, and where fewer than four of the keyframes before
/// it have.
std::optional<GroundMotion> FindGroundMotion(const Map& map, KeyframeId newest,
                                             const KnownGround& ground);

/// Predicts the camera's position at a later time, seconds, while it turns to `rotation`
/// (world_from_camera). Empty at a time that is not later: recordings repeat time stamps.
std::optional<PositionPrior> PredictPosition(const GroundMotion& motion, double timestamp,
                                             const Eigen::Quaterniond& rotation);

}  // namespace orb360
