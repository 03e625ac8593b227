#include "slam/pipeline/ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/geometry/ground_plane.h"

namespace orb360 {
namespace {

// Keyframes whose landmarks are looked at as well: its own are few, below.
constexpr size_t kNeighbours = 5;
constexpr double kSameHeight = 0.1;    // as a fraction
constexpr double kMinAgreement = 0.6;  // fraction of the keyframes with the same height
constexpr size_t kMinKeyframes = 3;

// Before anything is known of the ground.
constexpr GroundPlaneOptions kFirstLook{.min_below = 0.35,
                                        .max_tilt = 0.7854,
                                        .tolerance = 0.08,
                                        .min_points = 20,
                                        .min_fraction = 0.25};

// Landmarks around a keyframe, relative to its camera in the axes of the world.
std::vector<Eigen::Vector3d> PointsAround(const Map& map, const Keyframe& keyframe) {
  std::vector<LandmarkId> ids = keyframe.landmarks;
  const std::vector<Map::Covisible> neighbours =
      map.FindCovisible(keyframe.landmarks, 1, keyframe.id);
  for (size_t i = 0; i < std::min(kNeighbours, neighbours.size()); ++i) {
    const std::vector<LandmarkId>& seen = map.keyframe(neighbours[i].keyframe).landmarks;
    ids.insert(ids.end(), seen.begin(), seen.end());
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<Eigen::Vector3d> points;
  points.reserve(ids.size());
  for (const LandmarkId id : ids) {
    if (id == kNoId) continue;
    points.push_back(map.landmark(id).position - keyframe.world_from_camera.translation);
  }
  return points;
}

}  // namespace

std::optional<KnownGround> EstimateGround(const Map& map, std::span<const KeyframeId> keyframes) {
  std::vector<GroundPlane> planes;
  std::vector<double> heights;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.keyframe(id);
    const Eigen::Vector3d up = keyframe.world_from_camera.rotation * Eigen::Vector3d::UnitZ();
    std::optional<GroundPlane> plane = FitGroundPlane(PointsAround(map, keyframe), up, kFirstLook);
    if (!plane) continue;
    heights.push_back(plane->height);
    planes.push_back(std::move(*plane));
  }
  if (planes.size() < kMinKeyframes) return std::nullopt;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  KnownGround ground{Eigen::Vector3d::Zero(), *middle};
  size_t agreeing = 0;
  for (const GroundPlane& plane : planes) {
    if (std::abs(plane.height / ground.camera_height - 1) > kSameHeight) continue;
    ground.up += plane.normal;
    ++agreeing;
  }
  if (agreeing < kMinAgreement * static_cast<double>(keyframes.size())) return std::nullopt;
  ground.up.normalize();
  return ground;
}

std::optional<Eigen::Vector3d> GroundNormal(const Map& map, KeyframeId keyframe,
                                            const Eigen::Vector3d& up) {
  const std::optional<GroundPlane> plane =
      FitGroundPlane(PointsAround(map, map.keyframe(keyframe)), up, {});
  if (!plane) return std::nullopt;
  return plane->normal;
}

}  // namespace orb360
