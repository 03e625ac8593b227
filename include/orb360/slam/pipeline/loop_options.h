#pragma once

namespace orb360 {

class OptionSchema;

struct LoopOptions {
  /// Recognise places: close loops, join maps, find a lost camera by what it sees.
  bool enabled = true;
  /// A place is looked at more closely when it is this much like the newest keyframe, as a fraction
  /// of how much the keyframe before is.
  double min_similarity = 0.25;
  /// Places looked at for each lost frame; for a keyframe it is the one most like it.
  int max_candidates = 3;
  /// Landmarks of a place that must be found in the image ...
  int min_inliers = 40;
  /// ... and the fraction of those that should be visible and are often seen: what merely looks
  /// alike shows the facades that are repeated and misses what stands around them.
  double min_found_fraction = 0.2;
  /// Keyframes that must lead to the same correction, out of twice as many in a row.
  int min_agreeing = 3;
  /// How far their corrections may differ: in position, fraction of the median range; in direction,
  /// radians; in the logarithm of the scale.
  double max_disagreement = 0.1;
  /// A loop is at least this long, multiples of the median range.
  double min_length = 5.0;
  /// What a map can have drifted: fraction of the way round, radians, a factor of scale. A street
  /// that looks like another one is farther away than that.
  double max_drift = 0.1;
  double max_turn = 0.3;
  double max_scale = 1.5;
  /// Frames after which a correction is adopted; it is computed beside tracking meanwhile.
  int correction_frames = 12;
  /// The same for the bundle adjustment of the whole map that follows, for each of its keyframes.
  double bundle_frames = 0.5;
  /// Iterations of each round of the bundle adjustment of the whole map.
  int bundle_iterations = 5;
  /// The camera's height over the ground as LocalBundleOptions::height_sigma, but less certain: all
  /// keyframes of a map hold its scale together, and a road that is not even would bend their path.
  double height_sigma = 0.02;
};

/// Registers the keys of the section `loop`.
void RegisterOptions(OptionSchema* schema, LoopOptions* options);

}  // namespace orb360
