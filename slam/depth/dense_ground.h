#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/depth/dense_depth.h"

namespace orb360 {

/// The ground under a camera as completed depth shows it. A camera of known height makes metres of
/// it: ln(metres per unit) = ln(height in metres) - log_height, with the same standard deviation.
struct DenseGround {
  Eigen::Vector3d up;     // its normal, unit
  double log_height = 0;  // ln of the camera's height over it, in the unit of the depth
  double sigma = 0;       // standard deviation of that
};

struct DenseGroundOptions {
  /// Pixels are ground where the network gives it this probability.
  double min_probability = 0.5;
  /// Standard deviation of the logarithm of the height from one keyframe when its ground is
  /// perfectly flat: roads are not, and cameras sway.
  double height_sigma = 0.01;
  /// Largest difference of that logarithm between the plane and the network's own guess: where they
  /// disagree more, neither is believed.
  double max_disagreement = 0.3;
};

/// The plane through the pixels of the ground; where the network does not tell them, through most
/// of those below the horizon. `up`: what is known of its normal, unit, in the camera, like the
/// result. Empty where no plane is found, or where the network guesses another height.
std::optional<DenseGround> FindGround(const DenseDepth& depth, const Eigen::Vector3d& up,
                                      const DenseGroundOptions& options);

/// Several keyframes' measurements of one ground, in one frame and unit: the median of the heights,
/// weighted by certainty; its standard deviation from their spread around it, or from their own
/// where that is larger. Empty for none.
std::optional<DenseGround> FuseGrounds(std::span<const DenseGround> grounds);

}  // namespace orb360
