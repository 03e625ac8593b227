#pragma once

namespace orb360 {

class OptionSchema;

struct InitializerOptions {
  /// Matches within this angle first (slow motion, few mistakes), then over the whole sphere.
  double nearby_radius = 0.3;
  /// Landmarks the first map must have.
  int min_landmarks = 80;
  /// Median parallax of the matches that are not far away, which makes a baseline, radians ...
  double min_parallax = 0.026;
  /// ... and in standard deviations of a feature on pyramid level 0: with less, the direction of
  /// motion is a guess.
  double min_parallax_sigmas = 5.0;
  /// Parallax of a single landmark, radians.
  double min_landmark_parallax = 0.01;
  /// Of all matches, the fraction that must agree with the motion.
  double min_inlier_ratio = 0.5;
};

/// Registers the keys of the section `initializer`.
void RegisterOptions(OptionSchema* schema, InitializerOptions* options);

}  // namespace orb360
