#include "slam/pipeline/first_steps.h"

#include <optional>
#include <vector>

#include "slam/geometry/triangulation.h"
#include "slam/pipeline/ground_steps.h"

namespace orb360 {
namespace {

void TriangulateAnew(Map* map) {
  for (LandmarkId id = 0; id < map->landmark_end(); ++id) {
    if (!map->HasLandmark(id)) continue;
    std::vector<Rigid3> camera_from_world;
    std::vector<Eigen::Vector3d> bearings;
    for (const Observation& o : map->landmark(id).observations) {
      const Keyframe& keyframe = map->keyframe(o.keyframe);
      camera_from_world.push_back(keyframe.world_from_camera.Inverse());
      bearings.push_back(keyframe.features->bearings[o.feature]);
    }
    // Far landmarks stay where they are.
    if (const auto position = Triangulate(camera_from_world, bearings)) {
      map->landmark(id).position = *position;
    }
  }
  for (const KeyframeId id : map->KeyframeIds()) RemoveWrongObservations(id, map);
  for (LandmarkId id = 0; id < map->landmark_end(); ++id) {
    if (map->HasLandmark(id)) map->UpdateAppearance(id);
  }
}

}  // namespace

void AlignFirstKeyframes(const KnownGround& ground, const cv::Mat& mask, Map* map) {
  const std::vector<KeyframeId> ids = map->KeyframeIds();
  bool has_moved = false;
  for (size_t i = ids.size(); i-- > 1;) {
    const Keyframe& later = map->keyframe(ids[i]);
    if (later.ground_steps.empty()) MeasureGroundSteps(later.id, ground, mask, map);
    if (later.ground_steps.empty()) continue;
    const GroundStepFrom& step = later.ground_steps.front();
    if (!map->HasKeyframe(step.keyframe)) continue;
    const Rigid3& from = map->keyframe(step.keyframe).world_from_camera;
    const std::optional<Rigid3> pose =
        PoseByStep(step, from, later.world_from_camera, ground.camera_height);
    if (!pose) continue;
    // What would move the later keyframe there moves the earlier ones the other way.
    const Rigid3 correction = later.world_from_camera * pose->Inverse();
    for (size_t j = 0; j < i; ++j) {
      Rigid3& earlier = map->keyframe(ids[j]).world_from_camera;
      earlier = correction * earlier;
      earlier.rotation.normalize();
    }
    has_moved = true;
  }
  if (has_moved) TriangulateAnew(map);
}

}  // namespace orb360
