#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <orb360/slam/pipeline/present_state.h>

namespace orb360 {

/// A copy of what the viewer shows of a run while it goes on.
struct LiveSnapshot {
  struct Keyframe {
    KeyframeId id = kNoId;
    int frame = 0;  ///< Index in the input.
    Rigid3 map_from_camera;
  };
  /// A landmark in the frame of a keyframe that observes it: corrections of the map move it with
  /// the keyframe.
  struct Landmark {
    KeyframeId keyframe = kNoId;
    Eigen::Vector3f position;
    Color color{};
  };
  struct Feature {
    Eigen::Vector2f pixel;
    bool is_matched = false;  ///< It shows a landmark that agrees with the pose.
  };
  /// The present map when no job owned it last.
  struct MapPart {
    std::vector<Keyframe> keyframes;
    std::vector<std::array<int, 2>> links;  ///< Ids of keyframes that observe the same landmarks.
    std::vector<Landmark> landmarks;
  };

  int frame = 0;
  double timestamp = 0;  ///< Seconds.
  TrackingState state = TrackingState::kInitializing;
  int map_number = 0;
  cv::Mat image;  ///< CV_8UC3, BGR.
  std::vector<Feature> features;
  std::optional<Rigid3> map_from_camera;
  std::optional<KnownGround> ground;
  std::vector<ClosedLoop> loops;
  /// World of written files, as far as it is known: level where the ground is known.
  Rigid3 world_from_map;
  int revision = 0;  ///< Number of the copy of `map`, from 1; 0: there is none.
  std::shared_ptr<const MapPart> map = std::make_shared<MapPart>();  ///< Never null.
};

/// What becomes of a run that is shown.
struct LiveControl {
  bool is_paused = false;   ///< The user wants no further frames.
  bool is_waiting = false;  ///< The run stands still for that reason.
  bool is_finishing =
      false;  ///< No further frame is tracked; the map and the cloud are being made.
};

/// Copies the map. Landmarks that one keyframe observes alone are left out: many of them vanish.
LiveSnapshot::MapPart CopyMap(const Map& map);

/// The page's `live.json`: `frame`, `time` (seconds), `state` (`initializing`, `tracking`, `lost`,
/// `finishing`), `isPaused`, `isWaiting`, `map`, `revision`, `size` (width and height of the
/// image), `pose` and each of `keyframes` (id, frame, and x y z qx qy qz qw of the optical camera
/// frame in the world), `links` (pairs of ids), `loops` (pairs of frames), `cameraHeight` (units of
/// the world, which are metres from the time on that it is known; else null) and `landmarks`, their
/// number.
std::string LiveJson(const LiveSnapshot& snapshot, const LiveControl& control);

/// The page's `live.image`, an image with the features of the same frame. Little endian: frame,
/// number of features (uint32), for each u and v in 1/10000 of width and height and 1 where it is
/// matched (3 uint16), then a JPEG of at most 1280 pixels' width; none before the first frame.
std::string LiveImage(const LiveSnapshot& snapshot);

/// The page's `live.points`, little endian: revision, number of landmarks (uint32), then for each
/// the id of its keyframe (int32), its position in the optical camera frame of that (3 float32),
/// and red, green, blue, 0 (uint8).
std::string LivePoints(const LiveSnapshot& snapshot);

}  // namespace orb360
