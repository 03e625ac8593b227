#pragma once

namespace orb360 {

class OptionSchema;

/// Where metres come from: a camera moves at a known height over the ground that it sees.
struct ScaleOptions {
  /// Off: the scale of a map is arbitrary, and drifts.
  bool from_ground = true;
  /// Of the camera over the ground, metres; 0: unknown, kAssumedHeight is taken.
  double camera_height = 0;
  static constexpr double kAssumedHeight = 1.6;

  double height() const { return camera_height > 0 ? camera_height : kAssumedHeight; }
};

/// Registers `camera.height_m` and `scale.from_ground`.
void RegisterOptions(OptionSchema* schema, ScaleOptions* options);

}  // namespace orb360
