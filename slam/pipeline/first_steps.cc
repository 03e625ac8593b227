#include "slam/pipeline/first_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "slam/pipeline/ground_steps.h"
#include "slam/pipeline/retriangulation.h"

namespace orb360 {
namespace {

// Longest time over which a step tells the one before it, seconds, and how far that one may be from
// it, as a fraction of its length, before it is replaced.
constexpr double kMaxGap = 1.0;
constexpr double kMaxChange = 0.5;

// The pose of a keyframe relative to one before it whose step was not measured, if that is far from
// what the step after it lets expect: carriers change their speed and direction little in that
// time.
std::optional<Rigid3> PoseByNextStep(const Keyframe& earlier, const Keyframe& later,
                                     const Keyframe& next, double camera_height) {
  if (next.ground_steps.empty()) return std::nullopt;
  const GroundStepFrom& step = next.ground_steps.front();
  if (step.keyframe != later.id) return std::nullopt;
  const double elapsed = later.timestamp - earlier.timestamp;
  const double fraction = elapsed / (next.timestamp - later.timestamp);
  if (!(fraction > 0 && std::isfinite(fraction)) || elapsed > kMaxGap) return std::nullopt;
  const Rigid3& to = later.world_from_camera;
  const Eigen::Vector3d motion =
      fraction * step.ratio * camera_height * (to.rotation * step.direction1);
  const Eigen::Vector3d tracked = to.translation - earlier.world_from_camera.translation;
  if ((tracked - motion).norm() < kMaxChange * motion.norm()) return std::nullopt;
  return Rigid3{to.rotation, earlier.world_from_camera.translation + motion};
}

}  // namespace

void AlignFirstKeyframes(const KnownGround& ground, const cv::Mat& mask, Map* map) {
  const std::vector<KeyframeId> ids = map->KeyframeIds();
  const bool is_of_this_run =
      std::ranges::all_of(ids, [&](KeyframeId id) { return map->keyframe(id).IsOfThisRun(); });
  if (map->keyframe_end() > kGroundSearch || !is_of_this_run) return;
  bool has_moved = false;
  for (size_t i = ids.size(); i-- > 1;) {
    const Keyframe& later = map->keyframe(ids[i]);
    if (later.ground_steps.empty()) MeasureGroundSteps(later.id, ground, mask, map);
    std::optional<Rigid3> pose;
    if (later.ground_steps.empty()) {
      if (i + 1 == ids.size()) continue;
      pose = PoseByNextStep(map->keyframe(ids[i - 1]), later, map->keyframe(ids[i + 1]),
                            ground.camera_height);
    } else {
      const GroundStepFrom& step = later.ground_steps.front();
      if (!map->HasKeyframe(step.keyframe)) continue;
      const Rigid3& from = map->keyframe(step.keyframe).world_from_camera;
      pose = PoseByStep(step, from, later.world_from_camera, ground.camera_height);
    }
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
  if (!has_moved) return;
  for (LandmarkId id = 0; id < map->landmark_end(); ++id) {
    if (map->HasLandmark(id)) Retriangulate(id, map);
    if (map->HasLandmark(id)) map->UpdateAppearance(id);
  }
}

}  // namespace orb360
