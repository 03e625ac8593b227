#include "slam/pipeline/ground_motion.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/bearing.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

// Number of changes of the velocity from which their variance is estimated.
constexpr int kChanges = 6;
constexpr int kMinChanges = 3;
// Standard deviations of a change beside those that have been seen lately: relative to the speed,
// and of the angle, rad. For up and down it is that of the angle as well.
constexpr double kLeastChange = 0.02;

// The velocity that the step to a keyframe shows, in its camera's frame.
struct Velocity {
  double timestamp;
  Eigen::Vector3d value;
};

std::optional<Velocity> VelocityAt(const Map& map, KeyframeId id, const KnownGround& ground) {
  const Keyframe& keyframe = map.keyframe(id);
  for (const GroundStepFrom& step : keyframe.ground_steps) {
    if (!map.HasKeyframe(step.keyframe)) continue;
    const double elapsed = keyframe.timestamp - map.keyframe(step.keyframe).timestamp;
    if (!(elapsed > 0)) continue;
    return Velocity{keyframe.timestamp,
                    step.ratio * ground.camera_height / elapsed * step.direction2};
  }
  return std::nullopt;
}

}  // namespace

std::optional<GroundMotion> FindGroundMotion(const Map& map, KeyframeId newest,
                                             const KnownGround& ground) {
  const std::optional<Velocity> now = VelocityAt(map, newest, ground);
  if (!now) return std::nullopt;
  Velocity later = *now;
  double elapsed = 0;
  double speed_changes = 0;  // sums of squares
  double angle_changes = 0;
  int count = 0;
  for (KeyframeId id = newest - 1; id >= 0 && count < kChanges; --id) {
    if (!map.HasKeyframe(id)) continue;
    if (!map.keyframe(id).IsOfThisRun()) break;
    const std::optional<Velocity> earlier = VelocityAt(map, id, ground);
    if (!earlier) continue;
    speed_changes += std::pow(std::log(later.value.norm() / earlier->value.norm()), 2);
    angle_changes += std::pow(AngleBetween(later.value, earlier->value), 2);
    elapsed += later.timestamp - earlier->timestamp;
    ++count;
    later = *earlier;
  }
  if (count < kMinChanges || !(elapsed > 0)) return std::nullopt;
  return GroundMotion{.timestamp = now->timestamp,
                      .world_from_camera = map.keyframe(newest).world_from_camera,
                      .velocity = now->value,
                      .speed_variance = speed_changes / elapsed,
                      .angle_variance = angle_changes / elapsed};
}

std::optional<PositionPrior> PredictPosition(const GroundMotion& motion, double timestamp,
                                             const Eigen::Quaterniond& rotation) {
  const double elapsed = timestamp - motion.timestamp;
  if (!(elapsed > 0)) return std::nullopt;
  const Rigid3& from = motion.world_from_camera;
  // Along an arc the chord has the direction that the camera has half-way.
  const Eigen::Vector3d turn = LogSo3(from.rotation.conjugate() * rotation);
  const Eigen::Vector3d step = from.rotation * (ExpSo3(0.5 * turn) * (elapsed * motion.velocity));
  const double length = step.norm();
  const double along =
      length * std::hypot(kLeastChange, std::sqrt(motion.speed_variance * elapsed));
  const double across =
      length * std::hypot(kLeastChange, std::sqrt(motion.angle_variance * elapsed));
  const Eigen::Vector3d direction = step / length;
  const Eigen::Matrix3d projection = direction * direction.transpose();
  return PositionPrior{
      .position = from.translation + step,
      .sqrt_information = projection / along + (Eigen::Matrix3d::Identity() - projection) / across};
}

}  // namespace orb360
