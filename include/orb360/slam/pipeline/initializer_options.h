#pragma once

namespace orb360 {

class OptionSchema;

/// How the first map of a run, or a new one after a loss, is made from two views.
struct InitializerOptions {
  /// Angle within which features of the two views are matched at first, radians. Slow motion gives
  /// few wrong matches there. If they give no motion, features are matched over the whole sphere.
  double nearby_radius = 0.3;
  /// Least number of landmarks of the map.
  int min_landmarks = 80;
  /// Least median parallax of the matches that are not far away (min_landmark_parallax), radians.
  double min_parallax = 0.026;
  /// Least median parallax in standard deviations of a feature on pyramid level 0. With less, the
  /// direction of motion is a guess.
  double min_parallax_sigmas = 5.0;
  /// Least parallax of a single landmark, radians.
  double min_landmark_parallax = 0.01;
  /// Least fraction of the matches that must agree with the motion.
  double min_inlier_ratio = 0.5;
};

/// Registers the keys of the section `initializer`.
void RegisterOptions(OptionSchema* schema, InitializerOptions* options);

}  // namespace orb360
