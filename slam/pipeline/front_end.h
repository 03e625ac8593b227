#pragma once

#include <optional>
#include <variant>

#include <opencv2/core.hpp>

#include "slam/features/orb_extractor.h"
#include "slam/pipeline/atlas.h"
#include "slam/pipeline/initial_map.h"
#include "slam/pipeline/landmark_counts.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/options.h"
#include "slam/pipeline/pending_frames.h"
#include "slam/pipeline/relocalization.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

/// From a frame to its features and pose. It is in one of three states; what moves the world
/// changes all that it holds (Apply).
///
/// `num_threads` is the number of OpenMP threads; no result depends on it.
class FrontEnd {
 public:
  struct Initializing {};  // no map so far
  struct Tracking {
    TrackedFrame last;
    std::optional<TrackedFrame> before_last = {};
  };
  struct Lost {
    Rigid3 last_world_from_camera = {};  // the last pose that was known
    int since = 0;                       // number of frames processed when it was lost
    KeyframeId next_keyframe = 0;        // see Relocalize
  };
  /// What happened so far.
  struct Events {
    std::optional<int> initialized_at;  // frame index
    int num_lost = 0;
    int num_relocalized = 0;
  };

  /// `mask`: CV_8U of the frames' size, 0 where features are left out; may be empty.
  FrontEnd(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask);

  /// `image`: CV_8UC3, BGR, of the camera's size.
  PendingFrame Extract(int index, double timestamp, const cv::Mat& image, int num_threads);
  /// The image pyramid of the last frame, which is then no longer here.
  SpherePyramid TakePyramid() { return extractor_.TakePyramid(); }

  bool is_initializing() const { return std::holds_alternative<Initializing>(state_); }
  /// Null in other states.
  const Tracking* tracking() const { return std::get_if<Tracking>(&state_); }
  const Lost* lost() const { return std::get_if<Lost>(&state_); }
  const Events& events() const { return events_; }
  const LocalMap& local() const { return local_; }
  double pixel_sigma() const { return pixel_sigma_; }  // rad, on pyramid level 0

  /// Tracks a frame in the local map. False where it is not found. State: tracking.
  bool Track(const PendingFrame& frame, int num_threads, Atlas* atlas);
  /// Gives up, at a frame that is remembered. State: tracking, then lost.
  void Lose(PendingFrame frame, int num_frames, const Map& map);
  /// Begins in a map made earlier, in which the camera is to be found.
  void StartLost(const Map& map);

  /// Looks for the camera. State: lost.
  std::optional<Relocalization> Find(const PendingFrame& frame, int num_threads, Atlas* atlas);
  /// Goes on tracking where the camera was found, in the present map, and tracks what was
  /// remembered backwards. State: lost, then tracking.
  void Resume(const PendingFrame& frame, Relocalization found, int num_threads, Atlas* atlas);
  void Remember(PendingFrame frame) { pending_.Remember(std::move(frame)); }

  /// Makes a map of the frame and an earlier one, if they show enough motion; otherwise the frame
  /// is remembered. After a loss the new map begins at the last pose and in the scale of the one
  /// before. State: initializing or lost.
  std::optional<InitialMap> Initialize(const PendingFrame& frame, int num_threads);
  /// Goes on tracking in the map just made, which is the present one. State: tracking.
  void StartTracking(const InitialMap& initial, int num_threads, Atlas* atlas);

  /// Whether the last frame is to become a keyframe. State: tracking.
  bool NeedsKeyframe() const;
  /// Looks for the keyframe that shares most with the last frame. State: tracking.
  void UpdateLocalMap(Map* map);
  /// The depth of a keyframe of the map is completed.
  void UseDepth(const Keyframe& keyframe);
  /// Leaves the present map, to go on in another.
  void LeaveMap(Map* map) { counts_.MoveTo(map); }

  /// Moves everything held here, after the map has changed.
  void Apply(const MapUpdate& update, Map* map);

 private:
  void Anchor(const TrackedFrame& frame, Atlas* atlas) const;
  void TrackPendingBackwards(TrackedFrame last, int num_threads, Atlas* atlas);

  const Options options_;
  const cv::Mat mask_;
  const double pixel_sigma_;
  OrbExtractor extractor_;
  std::variant<Initializing, Tracking, Lost> state_;
  PendingFrames pending_;
  LocalMap local_;
  LandmarkCounts counts_;
  Events events_;
};

}  // namespace orb360
