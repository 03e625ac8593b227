#pragma once

#include <optional>
#include <variant>

#include <opencv2/core.hpp>

#include "slam/features/orb_extractor.h"
#include "slam/pipeline/atlas.h"
#include "slam/pipeline/ground_motion.h"
#include "slam/pipeline/initial_map.h"
#include "slam/pipeline/landmark_counts.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/pending_frames.h"
#include "slam/pipeline/relocalization.h"
#include "slam/pipeline/tracker.h"
#include <orb360/slam/pipeline/frame_report.h>
#include <orb360/slam/pipeline/options.h>

namespace orb360 {

/// Extracts the features of frames and estimates their poses. It is in one of three states. When
/// the map moves, Apply moves all poses and points that the front end holds.
///
/// `num_threads` is the number of OpenMP threads; no result depends on it.
class FrontEnd {
 public:
  struct Initializing {};  ///< There is no map yet.
  struct Tracking {
    TrackedFrame last;
    std::optional<TrackedFrame> before_last = {};
  };
  struct Lost {
    /// What was known before. Empty in a loaded map.
    std::optional<Tracking> before = {};
    /// Number of frames that had been processed when the camera was lost.
    int since = 0;
    /// The keyframe at which Relocalize goes on.
    KeyframeId next_keyframe = 0;
  };
  /// Events so far.
  struct Events {
    std::optional<int> initialized_at;  ///< Index of the frame at which the first pose was known.
    int num_lost = 0;
    int num_relocalized = 0;
  };

  /// `mask` is CV_8U of the frames' size, 0 where features are left out, or empty.
  FrontEnd(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);

  /// Extracts the features of an image, CV_8UC3, BGR, of the camera's size. `timestamp` is in
  /// seconds.
  PendingFrame Extract(int index, double timestamp, const cv::Mat& image, int num_threads);
  /// Moves the image pyramid of the last frame out.
  SpherePyramid TakePyramid() {
    pyramid_of_.reset();
    return extractor_.TakePyramid();
  }
  /// Whether the pyramid is there and is that of the last tracked frame. State: tracking.
  bool HasPyramid() const { return pyramid_of_ == std::get<Tracking>(state_).last.index; }

  TrackingState state() const {
    if (is_initializing()) return TrackingState::kInitializing;
    return tracking() != nullptr ? TrackingState::kTracking : TrackingState::kLost;
  }
  bool is_initializing() const { return std::holds_alternative<Initializing>(state_); }
  /// The data of a state; null in other states.
  const Tracking* tracking() const { return std::get_if<Tracking>(&state_); }
  const Lost* lost() const { return std::get_if<Lost>(&state_); }
  const Events& events() const { return events_; }
  const LocalMap& local() const { return local_; }
  /// Angular noise of a feature on pyramid level 0, rad.
  double pixel_sigma() const { return pixel_sigma_; }
  /// CV_8U, 0 where features are left out; may be empty.
  const cv::Mat& mask() const { return mask_; }

  /// Tracks a frame in the local map. False where that fails. State: tracking.
  bool Track(const PendingFrame& frame, int num_threads, Atlas* atlas);
  /// Ends tracking at a frame without a pose, which is remembered. State: tracking, then lost.
  void Lose(PendingFrame frame, int num_frames, const Map& map);
  /// Begins in a loaded map, in which the camera has to be relocalized. State: then lost.
  void StartLost(const Map& map);

  /// Relocalizes the camera: for a moment where its motion has taken it, as after a frame in which
  /// something covered the view, then anywhere (Relocalize). State: lost.
  std::optional<Relocalization> Find(const PendingFrame& frame, int num_threads, Atlas* atlas);
  /// Resumes tracking at the pose that was found in the present map, and tracks the remembered
  /// frames backwards from there. State: lost, then tracking.
  void Resume(const PendingFrame& frame, Relocalization found, int num_threads, Atlas* atlas);
  void Remember(PendingFrame frame) { pending_.Remember(std::move(frame)); }

  /// Makes a map from the frame and an earlier one if there is enough motion between them;
  /// otherwise the frame is remembered. After a loss the new map begins at the last known pose and
  /// with the scale of the map before. State: initializing or lost.
  std::optional<InitialMap> Initialize(PendingFrame frame, int num_threads);
  /// Starts tracking in the map just made, which is the present one. State: then tracking.
  void StartTracking(const InitialMap& initial, int num_threads, Atlas* atlas);

  /// Whether the last frame should become a keyframe of the map, whose ground is known or not.
  /// State: tracking.
  bool NeedsKeyframe(const Map& map, bool has_ground) const;
  /// Whether the last frame of a run should become a keyframe: unless the camera stands where its
  /// reference keyframe is. State: tracking.
  bool HasMoved(bool has_ground) const;
  /// Adds the collected counts to the landmarks of the map, and makes the local map anew where
  /// another keyframe than its reference shares most landmarks with the last frame. State:
  /// tracking.
  void UpdateLocalMap(Map* map);
  /// Uses the motion over the ground at the newest keyframe, from now on; empty: it is not known.
  void SetGroundMotion(const std::optional<GroundMotion>& motion) { ground_motion_ = motion; }
  /// Uses the completed depth of a keyframe of the map.
  void UseDepth(const Keyframe& keyframe);
  /// Leaves the present map before tracking goes on in another one.
  void LeaveMap(Map* map) { counts_.MoveTo(map); }

  /// Moves all poses and points held here after the map has changed.
  void Apply(const MapUpdate& update, Map* map);

 private:
  /// Time for which a motion predicts where the camera is, seconds.
  static constexpr double kPredictable = 1.0;

  /// Distance of the last frame from its reference keyframe, in median ranges.
  double Motion() const;
  /// The pose at a time (seconds) by constant velocity in the camera's frame.
  static Rigid3 PredictPose(const Tracking& tracking, double timestamp);
  static TrackedFrame MakeTracked(const PendingFrame& frame, TrackResult result);
  void Anchor(const TrackedFrame& frame, Atlas* atlas, bool is_interpolated = false) const;
  void TrackPendingBackwards(TrackedFrame last, int num_threads, Atlas* atlas);
  /// Gives the pending frames between two frames interpolated poses.
  void InterpolatePending(const TrackedFrame& before, const TrackedFrame& after, Atlas* atlas);

  const Options options_;
  const cv::Mat mask_;
  const double pixel_sigma_;
  OrbExtractor extractor_;
  std::optional<int> pyramid_of_;  ///< Index of the frame whose pyramid the extractor has.
  std::variant<Initializing, Tracking, Lost> state_;
  PendingFrames pending_;
  LocalMap local_;
  std::optional<GroundMotion> ground_motion_;
  LandmarkCounts counts_;
  Events events_;
};

}  // namespace orb360
