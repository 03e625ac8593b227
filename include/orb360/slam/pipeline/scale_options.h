#pragma once

namespace orb360 {

class OptionSchema;

/// How maps become metric: the camera moves at a known height over the ground that it sees
/// (docs/concepts/scale.md).
struct ScaleOptions {
  /// Whether the ground is sought. Without it, the scale of a map is arbitrary and drifts.
  bool from_ground = true;
  /// Height of the camera over the ground, metres; 0 if it is not known.
  double camera_height = 0;
  /// Standard deviation of that height, a fraction of it: a measuring tape, springs and tyres, the
  /// slope of the road under the carrier.
  double camera_height_sigma = 0.02;
  /// Height that is assumed where none is known, metres.
  static constexpr double kAssumedHeight = 1.6;

  /// Returns the height over the ground that the system uses, metres.
  double height() const { return camera_height > 0 ? camera_height : kAssumedHeight; }
};

/// Registers `camera.height_m`, `camera.height_sigma` and `scale.from_ground`.
void RegisterOptions(OptionSchema* schema, ScaleOptions* options);

}  // namespace orb360
