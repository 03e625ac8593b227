#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "apps/town/sensor/sensor_options.h"

namespace orb360::town {

/// Returns the direction that a panorama, stitched for infinitely distant surroundings, shows in
/// place of `bearing` (unit, camera frame) where it comes from a lens at `lens` (camera frame,
/// metres): the direction from the panorama's centre to the point that the lens sees along
/// `bearing`. The point is assumed to lie on a road 1.9 m below, or on walls 10 m away.
Eigen::Vector3d SeenThroughLens(const Eigen::Vector3d& lens, const Eigen::Vector3d& bearing);

/// Returns the panorama as two lenses back to back would give it (see DualLens).
cv::Mat3f StitchedFromTwoLenses(const DualLens& options, const cv::Mat3f& panorama);

}  // namespace orb360::town
