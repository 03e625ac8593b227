#pragma once

namespace orb360 {

class OptionSchema;

struct OrbOptions {
  int num_features = 2000;
  int num_levels = 8;
  /// Least FAST score of a feature, gray levels.
  int min_score = 8;
  /// Standard deviation of a feature's position, pixels of its own level.
  double pixel_sigma = 0.7;
};

/// Registers the keys of the section `features`.
void RegisterOptions(OptionSchema* schema, OrbOptions* options);

}  // namespace orb360
