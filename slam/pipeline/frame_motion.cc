#include "slam/pipeline/frame_motion.h"

#include <algorithm>
#include <vector>

#include "nn/base/statistics.h"
#include "slam/geometry/essential_matrix.h"

namespace orb360 {
namespace {

constexpr int kMinMatches = 50;
constexpr int kMinLengths = 5;
// Sine of the least angle between a bearing and the direction of the motion. Nearer to the epipole
// a landmark hardly constrains the length of the motion.
constexpr double kMinSine = 0.1;

// Returns the length of the motion that each landmark with a match gives. With X the landmark in
// the last camera's frame, t the direction of the motion and c the frame's bearing rotated into the
// last camera's frame, X - s t is parallel to c for s = ((c x t) . (c x X)) / |c x t|^2.
std::vector<double> Lengths(const Rigid3& last_from_frame, const Features& features,
                            const TrackedFrame& last, const LocalMap& local,
                            std::span<const Match> matches) {
  const Rigid3 last_from_world = last.world_from_camera.Inverse();
  std::vector<double> lengths;
  for (const Match& match : matches) {
    const LandmarkId id = last.landmarks[match.first];
    const LocalLandmark* landmark = id == kNoId ? nullptr : local.Find(id);
    if (landmark == nullptr) continue;
    const Eigen::Vector3d bearing = last_from_frame.rotation * features.bearings[match.second];
    const Eigen::Vector3d across = bearing.cross(last_from_frame.translation);
    if (across.norm() < kMinSine) continue;
    const Eigen::Vector3d point = last_from_world * landmark->position;
    lengths.push_back(across.dot(bearing.cross(point)) / across.squaredNorm());
  }
  return lengths;
}

}  // namespace

std::optional<Rigid3> PoseFromMotion(const Features& features, const TrackedFrame& last,
                                     const LocalMap& local, std::span<const Match> matches) {
  std::vector<Eigen::Vector3d> bearings1;
  std::vector<Eigen::Vector3d> bearings2;
  std::vector<double> sigmas1;
  std::vector<double> sigmas2;
  for (const Match& match : matches) {
    bearings1.push_back(last.features->bearings[match.first]);
    bearings2.push_back(features.bearings[match.second]);
    sigmas1.push_back(last.features->keypoints[match.first].sigma);
    sigmas2.push_back(features.keypoints[match.second].sigma);
  }
  RansacOptions ransac;
  ransac.min_inliers = std::max(kMinMatches, static_cast<int>(matches.size() / 2));
  const std::optional<RelativePose> motion =
      EstimateRelativePose(bearings1, bearings2, sigmas1, sigmas2, ransac);
  if (!motion) return std::nullopt;
  Rigid3 last_from_frame = motion->camera1_from_camera2;
  std::vector<double> lengths = Lengths(last_from_frame, features, last, local, matches);
  if (static_cast<int>(lengths.size()) < kMinLengths) return std::nullopt;
  last_from_frame.translation *= Median(lengths);
  return last.world_from_camera * last_from_frame;
}

}  // namespace orb360
