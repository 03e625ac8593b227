#include "slam/pipeline/ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/statistics.h"
#include "slam/geometry/ground_plane.h"

namespace orb360 {
namespace {

// Number of neighbouring keyframes whose landmarks are used as well, because a keyframe has only
// few landmarks below it.
constexpr size_t kNeighbours = 5;
// Largest difference between heights of the camera that count as equal, as a fraction.
constexpr double kSameHeight = 0.1;
// Least fraction of the keyframes that must have the same height.
constexpr double kMinAgreement = 0.6;
constexpr size_t kMinKeyframes = 3;

// How far below the camera a landmark may lie: in heights of the camera, and beside that as a
// fraction of its distance, because the ground slopes.
constexpr double kMaxDepth = 2.0;
constexpr double kMaxSlope = 0.1;

// Options for the first fit, before anything is known about the ground.
constexpr GroundPlaneOptions kFirstLook{.min_below = 0.35,
                                        .max_tilt = 0.7854,
                                        .tolerance = 0.08,
                                        .min_points = 20,
                                        .min_fraction = 0.25};

// Returns the landmarks around a keyframe, relative to its camera, in the axes of the world frame.
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

std::optional<KnownGround> AgreeOnGround(std::span<const GroundSighting> sightings,
                                         double min_agreeing) {
  if (sightings.empty()) return std::nullopt;
  std::vector<double> heights;
  for (const GroundSighting& sighting : sightings) heights.push_back(sighting.height);
  KnownGround ground{Eigen::Vector3d::Zero(), Median(heights)};
  size_t agreeing = 0;
  for (const GroundSighting& sighting : sightings) {
    if (std::abs(sighting.height / ground.camera_height - 1) > kSameHeight) continue;
    ground.up += sighting.up;
    ++agreeing;
  }
  if (agreeing < min_agreeing) return std::nullopt;
  ground.up.normalize();
  return ground;
}

std::optional<KnownGround> EstimateGround(const Map& map, std::span<const KeyframeId> keyframes) {
  std::vector<GroundSighting> sightings;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.keyframe(id);
    const Eigen::Vector3d up = keyframe.world_from_camera.rotation * Eigen::Vector3d::UnitZ();
    const std::optional<GroundPlane> plane =
        FitGroundPlane(PointsAround(map, keyframe), up, kFirstLook);
    if (plane) sightings.push_back({plane->normal, plane->height});
  }
  if (sightings.size() < kMinKeyframes) return std::nullopt;
  return AgreeOnGround(sightings, kMinAgreement * static_cast<double>(keyframes.size()));
}

std::optional<GroundSighting> GroundAt(const Map& map, KeyframeId keyframe,
                                       const Eigen::Vector3d& up) {
  const std::optional<GroundPlane> plane =
      FitGroundPlane(PointsAround(map, map.keyframe(keyframe)), up, {});
  if (!plane) return std::nullopt;
  return GroundSighting{plane->normal, plane->height};
}

void RemoveBelowGround(KeyframeId id, const KnownGround& ground, Map* map) {
  const std::vector<LandmarkId> landmarks = map->keyframe(id).landmarks;
  const Eigen::Vector3d center = map->keyframe(id).world_from_camera.translation;
  for (const LandmarkId landmark : landmarks) {
    if (landmark == kNoId || !map->HasLandmark(landmark)) continue;
    const Eigen::Vector3d offset = map->landmark(landmark).position - center;
    const double allowed = kMaxDepth * ground.camera_height + kMaxSlope * offset.norm();
    if (-offset.dot(ground.up) > allowed) map->RemoveLandmark(landmark);
  }
}

}  // namespace orb360
