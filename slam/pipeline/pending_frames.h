#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "slam/features/features.h"

namespace orb360 {

/// A frame without a pose so far.
struct PendingFrame {
  int index = 0;                                  // in the sequence
  double timestamp = 0;                           // s
  std::shared_ptr<const Features> features = {};  // null: forgotten
  /// How the camera is turned against an earlier frame, from which it has hardly moved.
  struct Turn {
    int reference;  // frame index
    Eigen::Quaterniond reference_from_camera;
  };
  std::optional<Turn> turn = {};
};

/// Frames that wait for a map, in which they are then tracked backwards. One of them is the
/// reference: the first view of the map that is to be made.
class PendingFrames {
 public:
  /// `max_frames`: more than these do not keep their features. Of those that are forgotten only how
  /// the camera was turned is kept, if it has not moved.
  explicit PendingFrames(int max_frames) : max_frames_(max_frames) {}

  bool empty() const { return frames_.empty(); }
  void Remember(PendingFrame frame);
  void Forget(int index);

  /// The reference; the newest frame becomes it where there is none. Contract: not empty.
  const PendingFrame& Reference();
  /// Makes the newest frame the reference; false where it is already.
  bool AdvanceReference();
  void ResetReference() { reference_ = kNone; }

  /// All of them, the newest first; none is left.
  std::vector<PendingFrame> TakeNewestFirst();

 private:
  static constexpr int kNone = -1;

  int max_frames_;
  int reference_ = kNone;  // frame index
  std::deque<PendingFrame> frames_;
};

}  // namespace orb360
