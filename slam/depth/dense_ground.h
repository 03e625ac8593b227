#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/depth/dense_ground_options.h>

namespace orb360 {

/// The ground under a camera as completed depth shows it. A camera of known height makes it metric:
/// ln(metres per unit) = ln(height in metres) - log_height, with the same standard deviation.
struct DenseGround {
  Eigen::Vector3d up;     // its normal, unit
  double log_height = 0;  // ln of the camera's height over it, in the unit of the depth
  double sigma = 0;       // standard deviation of that
};

/// Fits the plane through the pixels of the ground, or, if the network does not give them, through
/// most pixels below the horizon. `up` is the expected normal, a unit vector in the camera frame,
/// as is the result. Returns nullopt if no plane is found or the network estimates another height.
std::optional<DenseGround> FindGround(const DenseDepth& depth, const Eigen::Vector3d& up,
                                      const DenseGroundOptions& options);

/// Fuses measurements of one ground by several keyframes, in one frame and unit. The height is the
/// median, weighted by certainty. Its standard deviation follows from the spread around the median,
/// or from the single ones where that is larger. Returns nullopt without measurements.
std::optional<DenseGround> FuseGrounds(std::span<const DenseGround> grounds);

}  // namespace orb360
