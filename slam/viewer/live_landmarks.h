#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// The landmarks that a keyframe observes first, in its camera frame: corrections of the map move
/// them with the keyframe.
struct LandmarkGroup {
  struct Point {
    LandmarkId id = kNoId;
    Eigen::Vector3f position;
    Color color{};
  };
  int revision = 0;  ///< Of the map in which they changed last.
  /// Never null. Empty: the keyframe is gone, or observes no landmark first.
  std::shared_ptr<const std::vector<Point>> points = std::make_shared<std::vector<Point>>();
};

/// Landmarks by the id of their keyframe.
using LandmarkGroups = std::map<KeyframeId, LandmarkGroup>;

/// Returns the landmarks of maps for the given revision. Ids of the second map grow by the
/// keyframe_end() of the first, and so on. A group of `before` stays as it is, with its revision,
/// where no landmark has come or gone or moved by more than 1/200 of its range, so that pages need
/// not get it again. Landmarks that one keyframe observes alone are left out: many of them vanish.
LandmarkGroups GroupLandmarks(std::span<const Map> maps, int revision,
                              const LandmarkGroups& before);

/// The page's `live.points`, little endian: revision, number of groups that have changed after the
/// revision `since` (uint32), then for each the id of the keyframe (int32), number of points
/// (uint32), and for each point its position in the optical camera frame (3 float32), and red,
/// green, blue, 0 (uint8). No points: the page removes those that it has of the keyframe.
std::string LivePoints(const LandmarkGroups& groups, int revision, std::uint64_t since);

/// Number of all points.
size_t CountLandmarks(const LandmarkGroups& groups);

/// Appends a point as pages get it, 16 bytes. `position` is in a camera frame of memory.
void AppendLivePoint(const Eigen::Vector3f& position, const Color& color, std::string* bytes);

}  // namespace orb360
