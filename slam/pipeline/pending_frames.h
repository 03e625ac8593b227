#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <orb360/slam/features/features.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// A frame that has no pose yet.
struct PendingFrame {
  int index = 0;         ///< Index in the sequence.
  double timestamp = 0;  ///< Seconds.
  /// Null where the frame's features have been dropped.
  std::shared_ptr<const Features> features = {};
  /// Pyramid of the image, kept for the reference and the newest frame only; else null.
  std::shared_ptr<const SpherePyramid> image = {};
  /// The rotation of the camera relative to an earlier frame, from which it has hardly moved.
  struct Turn {
    int reference;  ///< Index of that frame.
    Eigen::Quaterniond reference_from_camera;
  };
  std::optional<Turn> turn = {};
};

/// Frames that wait for a map, in which they are then tracked backwards. One of them is the
/// reference, which becomes the first view of the next map.
class PendingFrames {
 public:
  /// `max_frames` is the number of frames that keep their features. Of older frames only the
  /// rotation of the camera is kept, where the camera has not moved.
  explicit PendingFrames(int max_frames) : max_frames_(max_frames) {}

  bool empty() const { return frames_.empty(); }
  const std::deque<PendingFrame>& frames() const { return frames_; }
  void Remember(PendingFrame frame);
  void Forget(int index);

  /// Returns the reference. Where there is none, the newest frame becomes the reference. Contract:
  /// there is a frame.
  const PendingFrame& Reference();
  /// Makes the newest frame the reference. False where it is the reference already.
  bool AdvanceReference();
  void ResetReference() { reference_ = kNone; }

  /// Moves all frames out, the newest first.
  std::vector<PendingFrame> TakeNewestFirst();

 private:
  static constexpr int kNone = -1;

  int max_frames_;
  int reference_ = kNone;  ///< Index of the reference frame.
  std::deque<PendingFrame> frames_;
};

}  // namespace orb360
