#pragma once

namespace orb360 {

class OptionSchema;

/// When a frame becomes a keyframe, and when its mapping is adopted.
struct KeyframeOptions {
  /// A frame becomes a keyframe when the number of landmarks that it tracks is less than this
  /// fraction of those that its reference keyframe shares with at least two others, when it has
  /// moved far (max_motion), or when it tracks few (urgent_inliers).
  double min_tracked_fraction = 0.75;
  /// Distance from the reference keyframe beyond which a frame becomes a keyframe, as a fraction of
  /// the median range of the reference's landmarks.
  double max_motion = 0.1;
  /// Distance from the reference keyframe below which no frame becomes a keyframe, as the same
  /// fraction, since a camera that stands still sees nothing new.
  double min_motion = 0.01;
  /// Number of frames after which the mapping of a keyframe is adopted. It runs beside tracking
  /// meanwhile.
  int mapping_frames = 6;
  /// Mapping is adopted earlier when the number of tracked landmarks has fallen below this fraction
  /// of the keyframe's.
  double min_held_fraction = 0.8;
  /// With fewer tracked landmarks than this, a frame becomes a keyframe and mapping is adopted at
  /// once.
  int urgent_inliers = 150;
  /// Number of keyframes around the reference whose landmarks tracking searches.
  int local_keyframes = 12;
};

/// Registers the keys of the section `keyframe`.
void RegisterOptions(OptionSchema* schema, KeyframeOptions* options);

}  // namespace orb360
