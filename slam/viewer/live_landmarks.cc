#include "slam/viewer/live_landmarks.h"

#include <algorithm>

#include "slam/io/byte_number.h"

namespace orb360 {
namespace {

using Point = LandmarkGroup::Point;

/// Movement of a landmark that is shown, over its range: half a degree as the keyframe sees it.
constexpr float kShownMovement = 1.0f / 200;

bool IsAsBefore(const std::vector<Point>& now, const std::vector<Point>& before) {
  return std::ranges::equal(now, before, [](const Point& a, const Point& b) {
    return a.id == b.id && (a.position - b.position).norm() <= kShownMovement * b.position.norm();
  });
}

}  // namespace

LandmarkGroups GroupLandmarks(std::span<const Map> maps, int revision,
                              const LandmarkGroups& before) {
  std::map<KeyframeId, std::vector<Point>> points;
  KeyframeId offset = 0;
  for (const Map& map : maps) {
    for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
      if (!map.HasLandmark(id)) continue;
      const Landmark& landmark = map.landmark(id);
      if (landmark.observations.size() < 2) continue;
      const KeyframeId keyframe = landmark.observations.front().keyframe;
      const Rigid3 camera_from_map = map.keyframe(keyframe).world_from_camera.Inverse();
      points[offset + keyframe].push_back(
          {id, (camera_from_map * landmark.position).cast<float>(), landmark.color});
    }
    offset += map.keyframe_end();
  }
  LandmarkGroups groups;
  for (auto& [keyframe, now] : points) {
    const auto found = before.find(keyframe);
    groups[keyframe] =
        found != before.end() && IsAsBefore(now, *found->second.points)
            ? found->second
            : LandmarkGroup{revision, std::make_shared<std::vector<Point>>(std::move(now))};
  }
  // Those that are gone are empty from now on.
  for (const auto& [keyframe, group] : before) {
    if (groups.contains(keyframe)) continue;
    groups[keyframe] = group.points->empty() ? group : LandmarkGroup{.revision = revision};
  }
  return groups;
}

std::string LivePoints(const LandmarkGroups& groups, int revision, std::uint64_t since) {
  std::string changed;
  std::uint32_t count = 0;
  for (const auto& [keyframe, group] : groups) {
    if (static_cast<std::uint64_t>(group.revision) <= since) continue;
    ++count;
    AppendLittleEndian(static_cast<std::int32_t>(keyframe), &changed);
    AppendLittleEndian(static_cast<std::uint32_t>(group.points->size()), &changed);
    for (const Point& point : *group.points) AppendLivePoint(point.position, point.color, &changed);
  }
  std::string bytes;
  AppendLittleEndian(static_cast<std::uint32_t>(revision), &bytes);
  AppendLittleEndian(count, &bytes);
  return bytes + changed;
}

size_t CountLandmarks(const LandmarkGroups& groups) {
  size_t count = 0;
  for (const auto& [keyframe, group] : groups) count += group.points->size();
  return count;
}

void AppendLivePoint(const Eigen::Vector3f& position, const Color& color, std::string* bytes) {
  // The optical camera frame: right, down, forward of -X forward, +Y right, +Z up.
  for (const float value : {position.y(), -position.z(), -position.x()}) {
    AppendLittleEndian(value, bytes);
  }
  for (const std::uint8_t value : color) *bytes += static_cast<char>(value);
  *bytes += '\0';
}

}  // namespace orb360
