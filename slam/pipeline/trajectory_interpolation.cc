#include "slam/pipeline/trajectory_interpolation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

// Longest time between two keyframes between which is interpolated, seconds.
constexpr double kMaxGap = 1.0;
// A gap whose speed is more than this many times that of the gaps beside it is a cut of the video:
// the camera went on at another place.
constexpr double kMaxSpeedChange = 2.0;
// Number of keyframes on each side whose deviations tell how smooth the motion is, and the least
// number of deviations.
constexpr size_t kNeighbours = 3;
constexpr int kMinDeviations = 2;
// Standard deviation beside the deviations that were seen, relative to the distance of the two
// keyframes.
constexpr double kFloor = 0.005;

// The position after a fraction of the motion from one pose to another along an arc. The chord to
// any point of an arc has the direction that the camera has half-way.
Eigen::Vector3d OnArc(const Rigid3& from, const Rigid3& to, double fraction) {
  const Eigen::Vector3d turn = LogSo3(from.rotation.conjugate() * to.rotation);
  const Eigen::Vector3d chord = from.rotation.conjugate() * (to.translation - from.translation);
  return from.translation +
         fraction * (from.rotation * (ExpSo3(0.5 * (fraction - 1) * turn) * chord));
}

bool IsShort(double gap) { return gap > 0 && gap <= kMaxGap; }

}  // namespace

TrajectoryInterpolation::TrajectoryInterpolation(const Map& map) {
  for (const KeyframeId id : map.KeyframeIds()) {
    const Keyframe& keyframe = map.keyframe(id);
    if (!keyframe.IsOfThisRun()) continue;
    nodes_.push_back({keyframe.timestamp, keyframe.world_from_camera});
  }
  std::ranges::stable_sort(nodes_, {}, &Node::timestamp);  // merged maps are not in this order
  for (size_t i = 1; i + 1 < nodes_.size(); ++i) {
    const Node& before = nodes_[i - 1];
    const Node& after = nodes_[i + 1];
    Node& node = nodes_[i];
    const double elapsed = node.timestamp - before.timestamp;
    if (!IsShort(elapsed) || !IsShort(after.timestamp - node.timestamp)) continue;
    if (IsCut(i) || IsCut(i + 1)) continue;
    const double fraction = elapsed / (after.timestamp - before.timestamp);
    const Eigen::Vector3d expected =
        OnArc(before.world_from_camera, after.world_from_camera, fraction);
    node.deviation = (node.world_from_camera.translation - expected).norm();
  }
}

bool TrajectoryInterpolation::IsCut(size_t index) const {
  const auto speed = [&](size_t i) {  // up to node i
    if (i == 0 || i >= nodes_.size()) return 0.0;
    const double elapsed = nodes_[i].timestamp - nodes_[i - 1].timestamp;
    if (!IsShort(elapsed)) return 0.0;
    const Eigen::Vector3d step =
        nodes_[i].world_from_camera.translation - nodes_[i - 1].world_from_camera.translation;
    return step.norm() / elapsed;
  };
  const double around = std::max(speed(index - 1), speed(index + 1));
  return around > 0 && speed(index) > kMaxSpeedChange * around;
}

std::optional<PositionPrior> TrajectoryInterpolation::PositionAt(double timestamp) const {
  const auto after = std::ranges::upper_bound(nodes_, timestamp, {}, &Node::timestamp);
  if (after == nodes_.begin() || after == nodes_.end()) return std::nullopt;
  const auto before = after - 1;
  const double gap = after->timestamp - before->timestamp;
  if (!IsShort(gap) || IsCut(static_cast<size_t>(after - nodes_.begin()))) return std::nullopt;
  double sum = 0;
  int count = 0;
  const auto index = static_cast<size_t>(after - nodes_.begin());
  for (size_t i = index - std::min(kNeighbours, index);
       i < std::min(index + kNeighbours, nodes_.size()); ++i) {
    if (nodes_[i].deviation < 0) continue;
    sum += nodes_[i].deviation * nodes_[i].deviation;
    ++count;
  }
  if (count < kMinDeviations) return std::nullopt;
  // The deviations span two gaps, so that this is on the safe side.
  const double fraction = (timestamp - before->timestamp) / gap;
  const double shape = std::sqrt(4 * fraction * (1 - fraction));
  const double distance =
      (after->world_from_camera.translation - before->world_from_camera.translation).norm();
  const double sigma = std::hypot(shape * std::sqrt(sum / count), kFloor * distance);
  if (!(sigma > 0)) return std::nullopt;
  return PositionPrior{
      .position = OnArc(before->world_from_camera, after->world_from_camera, fraction),
      .sqrt_information = Eigen::Matrix3d::Identity() / sigma};
}

}  // namespace orb360
