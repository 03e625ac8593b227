#pragma once

namespace orb360 {

class OptionSchema;

/// How features are extracted (docs/concepts/features.md).
struct OrbOptions {
  /// Number of features that are sought in each image.
  int num_features = 2000;
  /// Number of pyramid levels, 1 to 8, each smaller than the one before by a factor of 2^(1/4).
  int num_levels = 8;
  /// Least FAST score of a corner, gray levels.
  int min_score = 8;
  /// Standard deviation of a feature's position, pixels of its own pyramid level.
  double pixel_sigma = 0.7;
};

/// Registers the keys of the section `features`.
void RegisterOptions(OptionSchema* schema, OrbOptions* options);

}  // namespace orb360
