#pragma once

#include <optional>

#include <Eigen/Core>

#include <orb360/slam/depth/dense_depth.h>

namespace orb360 {

/// Returns the mean probability, weighted by solid angle, that what is within 60 degrees of
/// straight down shows ground. `up` is a unit vector in the camera frame. Empty if the network does
/// not tell ground.
std::optional<double> MeanGroundProbability(const DenseDepth& depth, const Eigen::Vector3d& up);

}  // namespace orb360
