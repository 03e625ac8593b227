#pragma once

#include <orb360/slam/optimization/optimizer.h>

namespace orb360 {

class OptionSchema;

/// How local bundle adjustment refines a new keyframe and its neighbours
/// (docs/concepts/bundle_adjustment.md). The larger the window is, the less the scale of a long
/// drive drifts, and the longer the adjustment takes.
struct LocalBundleOptions {
  /// Largest number of keyframes that move: the newest and those that share most landmarks with it.
  int max_keyframes = 10;
  /// Largest number of fixed keyframes outside of the window, which observe the same landmarks and
  /// hold them in place.
  int max_fixed_keyframes = 16;
  /// Least number of landmarks that a keyframe must share with the newest to move.
  int min_shared = 15;
  /// Largest number of iterations of Levenberg-Marquardt.
  int max_iterations = 4;
  /// Standard deviation of the camera's height over the plane through the ground around it, as a
  /// fraction of the height. Roads are not flat, and cameras sway.
  double height_sigma = 0.01;
  /// Solver of this and of every other bundle adjustment and pose graph of the system.
  Optimizer optimizer = Optimizer::kSchur;
};

/// Registers the keys of the section `bundle`. `optimizer` is registered as an Optimizer.
void RegisterOptions(OptionSchema* schema, LocalBundleOptions* options);
/// Registers `scale.height_sigma`, separately since it stands after the keys of ScaleOptions in the
/// configuration file.
void RegisterHeightSigma(OptionSchema* schema, LocalBundleOptions* options);

}  // namespace orb360
