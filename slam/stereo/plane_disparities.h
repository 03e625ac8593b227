#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace orb360 {

/// A plane that a camera may see.
struct PlaneHypothesis {
  Eigen::Vector3d normal;  ///< From the plane to the camera, unit vector.
  double distance;         ///< Of the camera from the plane, more than 0.
};

/// Disparities of two rectified spheres (RectifySphere), the first of which is `plane.distance`
/// from a plane: CV_32F, `width` columns and 2 `width` rows, pixels; negative where the plane is
/// not seen. `plane.normal` is in the rectified frame, whose first axis points from the first to
/// the second camera, `length` away.
cv::Mat PlaneDisparities(const PlaneHypothesis& plane, double length, int width);

}  // namespace orb360
