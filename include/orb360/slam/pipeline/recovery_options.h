#pragma once

namespace orb360 {

class OptionSchema;

/// What happens after a loss of tracking.
struct RecoveryOptions {
  /// Number of frames without a pose after which a new map is begun, if that succeeds before
  /// relocalization.
  int patience_frames = 15;
  /// Number of keyframes of the map in which each lost frame is sought.
  int keyframes_per_frame = 3;
  /// Largest number of frames without a pose that are remembered, to be tracked backwards once
  /// there is a map. Of older ones only how the camera was turned is kept, if it has not moved.
  int max_pending_frames = 600;
};

/// Registers the keys of the section `recovery`.
void RegisterOptions(OptionSchema* schema, RecoveryOptions* options);

}  // namespace orb360
