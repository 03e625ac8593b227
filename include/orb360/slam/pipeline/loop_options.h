#pragma once

namespace orb360 {

class OptionSchema;

/// How places are recognised and loops are closed (docs/concepts/loops_and_maps.md).
struct LoopOptions {
  /// Whether places are recognised, to close loops, to merge maps and to relocalize a lost camera.
  bool enabled = true;
  /// Least similarity score of a place that is verified, as a fraction of the largest score among
  /// the places that the camera still sees.
  double min_similarity = 0.25;
  /// Largest number of places that are verified for a lost frame. For a keyframe only the most
  /// similar one is.
  int max_candidates = 3;
  /// Least number of landmarks of a place that must be found in the image.
  int min_inliers = 40;
  /// Least fraction that must be found in the image of those landmarks of a place that should be
  /// visible there and are usually found. A place that only looks alike shows the facades that are
  /// repeated and lacks what stands around them.
  double min_found_fraction = 0.2;
  /// Number of keyframes, out of twice as many in a row, that must lead to the same correction.
  int min_agreeing = 3;
  /// Largest difference of their corrections: of the position as a fraction of the median range, of
  /// the direction in radians, and of the logarithm of the scale.
  double max_disagreement = 0.1;
  /// Least length of a loop along the path, multiples of the median range.
  double min_length = 5.0;
  /// Largest drift of the position that a loop may correct beside what the drift of its scale
  /// explains, as a fraction of the length of the loop. A street that looks like another one is
  /// farther away than that.
  double max_drift = 0.1;
  /// Largest drift of the direction that a loop may correct, radians.
  double max_turn = 0.3;
  /// Largest drift of the scale that a loop may correct, as a factor of at least 1. Where the
  /// ground is not seen, the scale drifts by a factor in a kilometre.
  double max_scale = 4.0;
  /// Number of frames after which a correction is adopted. It is computed beside tracking
  /// meanwhile.
  int correction_frames = 12;
  /// Number of frames, for each keyframe of the map, after which the bundle adjustment of the whole
  /// map that follows a correction is adopted.
  double bundle_frames = 0.5;
  /// Largest number of iterations of each round of the bundle adjustment of the whole map.
  int bundle_iterations = 5;
  /// Standard deviation of the camera's height over the ground in bundle adjustment of the whole
  /// map, as a fraction of the height. It is larger than LocalBundleOptions::height_sigma, because
  /// all keyframes of a map hold its scale together, and an uneven road would bend their path.
  double height_sigma = 0.02;
};

/// Registers the keys of the section `loop`.
void RegisterOptions(OptionSchema* schema, LoopOptions* options);

}  // namespace orb360
