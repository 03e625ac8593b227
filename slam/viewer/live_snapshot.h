#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/viewer/live_landmarks.h"
#include <orb360/slam/pipeline/present_state.h>

namespace orb360 {

/// A copy of what the viewer shows of a run while it goes on.
struct LiveSnapshot {
  struct Keyframe {
    KeyframeId id = kNoId;
    int frame = 0;  ///< Index in the input.
    Rigid3 map_from_camera;
  };
  struct Feature {
    Eigen::Vector2f pixel;
    bool is_matched = false;  ///< It shows a landmark that agrees with the pose.
  };
  /// The present map when no job owned it last, or all maps of a run that is finishing.
  struct MapPart {
    std::vector<Keyframe> keyframes;
    std::vector<std::array<int, 2>> links;  ///< Ids of keyframes that observe the same landmarks.
    LandmarkGroups landmarks;
  };

  /// World of written files, as far as it is known: level where the ground is known.
  Rigid3 world_from_map;
  std::optional<Rigid3> map_from_camera;
  std::optional<KnownGround> ground;
  double timestamp = 0;  ///< Seconds.
  std::chrono::steady_clock::time_point taken = std::chrono::steady_clock::now();
  int frame = 0;
  TrackingState state = TrackingState::kInitializing;
  int map_number = 0;
  /// Grows with each change of `map` and of `world_from_map`; 0: there is no map.
  int revision = 0;
  std::shared_ptr<const MapPart> map = std::make_shared<MapPart>();  ///< Never null.
  std::vector<Feature> features;
  std::vector<ClosedLoop> loops;
  cv::Mat image;  ///< CV_8UC3, BGR.
};

/// What becomes of a run that is shown.
struct LiveControl {
  bool is_paused = false;   ///< The user wants no further frames.
  bool is_waiting = false;  ///< The run stands still for that reason.
  bool is_finishing =
      false;  ///< No further frame is tracked; the map and the cloud are being made.
  /// How far the work after the last frame has got.
  struct Progress {
    std::string what;  ///< Such as `computing depth`.
    int done = 0;
    int count = 0;
    std::string of_what;  ///< What is counted, such as `frames`.
  };
  std::optional<Progress> progress = {};
  bool is_masked = false;  ///< Some of every image is left out: there is a `live.mask`.
  /// Wall times of the last frames by stage, ms: the median, and what 95 % of them do not exceed.
  std::map<std::string, std::array<double, 2>> times = {};
};

/// Copies maps, which have one world, as GroupLandmarks does.
LiveSnapshot::MapPart CopyMaps(std::span<const Map> maps, int revision,
                               const LandmarkGroups& before);

/// The page's `live.json`.
///
/// | key | meaning |
/// |---|---|
/// | `frame`, `time` | index, seconds |
/// | `age` | milliseconds since this was the state of the run |
/// | `state` | `initializing`, `tracking`, `lost`, `finishing` |
/// | `progress` | `what`, `done`, `count`, `ofWhat` of LiveControl::Progress, or null |
/// | `isPaused`, `isWaiting`, `isMasked` | as in LiveControl |
/// | `times` | by stage: `median` and `p95` of LiveControl::times |
/// | `map`, `revision` | as in LiveSnapshot |
/// | `size` | width and height of the image |
/// | `pose` | of the frame, or null: x y z qx qy qz qw of the optical camera frame in the world |
/// | `keyframes` | id, frame, and pose of each; null where `since` is the revision |
/// | `links` | pairs of ids of keyframes; null where `since` is the revision |
/// | `loops` | pairs of frames |
/// | `cameraHeight` | metres, from the time on that it is known; before that null |
/// | `landmarks`, `views` | number of landmarks, and of `num_views` of the dense cloud |
std::string LiveJson(const LiveSnapshot& snapshot, const LiveControl& control, size_t num_views,
                     std::uint64_t since);

/// The page's `live.image`, an image with the features of the same frame. Little endian: frame,
/// number of features (uint32), for each u and v in 1/10000 of width and height and 1 where it is
/// matched (3 uint16), then a JPEG of at most 1280 pixels' width; none before the first frame.
std::string LiveImage(const LiveSnapshot& snapshot);

/// The page's `live.mask`: a PNG with one channel of at most 1280 pixels' width, black where
/// nothing is looked for. Empty where `mask` is.
std::string LiveMask(const cv::Mat& mask);

}  // namespace orb360
