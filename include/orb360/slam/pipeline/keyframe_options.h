#pragma once

namespace orb360 {

class OptionSchema;

struct KeyframeOptions {
  /// A frame becomes a keyframe when it tracks less than this fraction of the landmarks that its
  /// reference keyframe shares with others ...
  double min_tracked_fraction = 0.75;
  /// ... or has moved by this fraction of the median range of its surroundings.
  double max_motion = 0.1;
  /// Standing still adds nothing: the least motion, as above.
  double min_motion = 0.01;
  /// Frames after which the mapping of a keyframe is adopted; it runs beside tracking meanwhile.
  int mapping_frames = 6;
  /// Earlier when the landmarks tracked have fallen below this fraction of the keyframe's ...
  double min_held_fraction = 0.8;
  /// ... or below this number; then a keyframe is needed anyway.
  int urgent_inliers = 150;
  /// Keyframes around the reference whose landmarks tracking searches.
  int local_keyframes = 12;
};

/// Registers the keys of the section `keyframe`.
void RegisterOptions(OptionSchema* schema, KeyframeOptions* options);

}  // namespace orb360
