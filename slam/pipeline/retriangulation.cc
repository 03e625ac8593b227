#include "slam/pipeline/retriangulation.h"

#include <optional>
#include <vector>

#include "slam/geometry/bearing.h"
#include "slam/geometry/triangulation.h"

namespace orb360 {
namespace {

// Standard deviations of a bearing beyond which it contradicts a position. The error of the pose is
// not known, so it is more than the 95 % bound.
constexpr double kMaxSigmas = 5.0;

struct Views {
  std::vector<Rigid3> camera_from_world;
  std::vector<Eigen::Vector3d> bearings;
  std::vector<double> sigmas;  // rad
};

Views ViewsOf(const Map& map, const Landmark& landmark) {
  Views views;
  for (const Observation& o : landmark.observations) {
    const Keyframe& keyframe = map.keyframe(o.keyframe);
    views.camera_from_world.push_back(keyframe.world_from_camera.Inverse());
    views.bearings.push_back(keyframe.features->bearings[o.feature]);
    views.sigmas.push_back(keyframe.features->keypoints[o.feature].sigma);
  }
  return views;
}

bool Agree(const Views& views, const Eigen::Vector3d& position) {
  for (size_t i = 0; i < views.bearings.size(); ++i) {
    const double error = AngleBetween(views.camera_from_world[i] * position, views.bearings[i]);
    if (!(error < kMaxSigmas * views.sigmas[i])) return false;
  }
  return true;
}

}  // namespace

void Retriangulate(LandmarkId id, Map* map) {
  const Views views = ViewsOf(*map, map->landmark(id));
  if (Agree(views, map->landmark(id).position)) return;
  const std::optional<Eigen::Vector3d> position =
      Triangulate(views.camera_from_world, views.bearings);
  if (position && Agree(views, *position)) {
    map->landmark(id).position = *position;
  } else {
    map->RemoveLandmark(id);
  }
}

}  // namespace orb360
