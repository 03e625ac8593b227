#include "slam/pipeline/keyframe_mapping.h"

#include <utility>

#include "slam/pipeline/first_steps.h"
#include "slam/pipeline/ground.h"
#include "slam/pipeline/ground_from_steps.h"
#include "slam/pipeline/lens_distance.h"

namespace orb360 {
namespace {

/// Returns the ground that the newest keyframes see. It is searched at first; once it is known, its
/// normal is updated, because roads go uphill and downhill.
std::optional<KnownGround> LookForGround(const Map& map, const std::optional<KnownGround>& known,
                                         const ScaleOptions& options) {
  if (!options.from_ground) return std::nullopt;
  const std::vector<KeyframeId> keyframes = map.KeyframeIds();
  if (!known) {
    constexpr size_t kEnough = 5;  // keyframes
    if (keyframes.size() < kEnough) return std::nullopt;
    const std::span newest = std::span(keyframes).last(kEnough);
    if (std::optional<KnownGround> ground = GroundFromSteps(map, newest)) return ground;
    const std::optional<KnownGround> ground = EstimateGround(map, newest);
    return ground && AgreesWithSteps(*ground, map, newest) ? ground : std::nullopt;
  }
  // Weight of a new normal. It is small, because the slope of a road changes slowly.
  constexpr double kWeight = 0.2;
  std::optional<Eigen::Vector3d> normal = GroundNormalFromSteps(map.keyframe(keyframes.back()));
  if (!normal) {
    if (const auto seen = GroundAt(map, keyframes.back(), known->up)) normal = seen->up;
  }
  if (!normal) return known;
  return KnownGround{.up = ((1 - kWeight) * known->up + kWeight * *normal).normalized(),
                     .camera_height = known->camera_height};
}

}  // namespace

MappedKeyframe MapKeyframe(KeyframeMapping job, const Options& options) {
  MappedKeyframe result{.active = std::move(job.active), .color = std::move(job.color)};
  Map& map = result.active.map;
  const KeyframeId id =
      IntegrateKeyframe(job.frame, std::move(job.pyramid), options.mapper, job.ground,
                        options.scale.from_ground ? std::optional(job.mask) : std::nullopt, &map);
  const double lengthening = CorrectForLenses(job.finished, &map);
  result.ground = LookForGround(map, job.ground, options.scale);
  if (job.ground && result.ground && lengthening != 1) {
    // The map was made with steps that looked too short.
    job.ground->camera_height /= lengthening;
    result.ground->camera_height = job.ground->camera_height;
    result.changes_unit = true;
  }
  if (result.ground && !job.ground) {
    result.changes_unit = true;
    AlignFirstKeyframes(*result.ground, job.mask, &map);
  }
  result.update.reference = id;
  result.update.correction =
      ToSimilarity(map.keyframe(id).world_from_camera * job.frame.world_from_camera.Inverse());
  if (job.ground) result.ground_motion = FindGroundMotion(map, id, *job.ground);
  if (job.completed_camera) {
    result.sparse = ProjectLandmarks(map, id, *job.completed_camera, options.depth.sparse);
  }
  if (options.loop.enabled) result.loop = result.active.places.Observe(map, id, job.finished);
  return result;
}

}  // namespace orb360
