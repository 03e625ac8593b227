#pragma once

namespace orb360 {

/// How the ground is found in completed depth (docs/concepts/scale.md).
struct DenseGroundOptions {
  /// Least probability, as the network gives it, of a pixel that counts as ground.
  double min_probability = 0.5;
  /// Standard deviation of the logarithm of the height from one keyframe whose ground appears
  /// perfectly flat, because roads are not flat and cameras sway.
  double height_sigma = 0.01;
  /// Largest difference of that logarithm between the plane and the network's own estimate. If they
  /// differ more, neither is used.
  double max_disagreement = 0.3;
};

}  // namespace orb360
