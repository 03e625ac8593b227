#include "slam/pipeline/tracker.h"

#include "slam/features/matching.h"
#include "slam/geometry/absolute_pose.h"
#include "slam/optimization/pose_refinement.h"
#include "slam/pipeline/projection_search.h"

namespace orb360 {
namespace {

// Matches of one frame, feature to landmark of a list, and the pose they give.
struct PoseFit {
  RefinedPose pose;
  std::vector<int> feature;   // by inlier
  std::vector<int> landmark;  // by inlier, index into the list
};

PoseFit FitPose(const Features& features, const Rigid3& initial,
                std::span<const LocalLandmark> landmarks,
                const std::vector<int>& landmark_of_feature) {
  PoseFit fit;
  std::vector<PoseObservation> observations;
  for (int f = 0; f < features.size(); ++f) {
    const int l = landmark_of_feature[f];
    if (l < 0) continue;
    observations.push_back(
        {landmarks[l].position, features.bearings[f], features.keypoints[f].sigma});
    fit.feature.push_back(f);
    fit.landmark.push_back(l);
  }
  fit.pose = RefinePose(initial, observations);
  size_t kept = 0;
  for (size_t i = 0; i < observations.size(); ++i) {
    if (!fit.pose.inliers[i]) continue;
    fit.feature[kept] = fit.feature[i];
    fit.landmark[kept] = fit.landmark[i];
    ++kept;
  }
  fit.feature.resize(kept);
  fit.landmark.resize(kept);
  return fit;
}

// From a pose known to a few sigmas: all of the local map.
std::optional<TrackResult> TrackLocalMap(const Features& features, const Rigid3& initial,
                                         const LocalMap& local, double pixel_sigma,
                                         const TrackerOptions& options) {
  const ProjectionSearchOptions search{
      .radius = options.local_radius_sigmas * pixel_sigma, .scale_radius = true, .ratio = 0.8};
  const ProjectionMatches matches =
      SearchByProjection(features, initial, local.landmarks, {}, search);
  const PoseFit fit = FitPose(features, initial, local.landmarks, matches.landmark_of_feature);
  if (fit.pose.num_inliers < options.min_inliers) return std::nullopt;
  TrackResult result{fit.pose.world_from_camera,
                     std::vector<LandmarkId>(features.size(), kNoId),
                     fit.pose.num_inliers,
                     {}};
  for (size_t i = 0; i < fit.feature.size(); ++i) {
    result.landmarks[fit.feature[i]] = local.landmarks[fit.landmark[i]].id;
  }
  for (size_t l = 0; l < local.landmarks.size(); ++l) {
    if (matches.expected[l]) result.expected.push_back(local.landmarks[l].id);
  }
  return result;
}

}  // namespace

std::optional<TrackResult> TrackFromPrediction(const Features& features,
                                               const Rigid3& predicted_world_from_camera,
                                               const TrackedFrame& last, const LocalMap& local,
                                               double pixel_sigma, const TrackerOptions& options) {
  std::vector<LocalLandmark> recent;
  for (const LandmarkId id : last.landmarks) {
    const LocalLandmark* landmark = id == kNoId ? nullptr : local.Find(id);
    if (landmark != nullptr) recent.push_back(*landmark);
  }
  for (const double radius : {options.narrow_radius, options.wide_radius}) {
    const ProjectionMatches matches =
        SearchByProjection(features, predicted_world_from_camera, recent, {}, {.radius = radius});
    if (matches.num_matches < options.min_motion_inliers) continue;
    const PoseFit fit =
        FitPose(features, predicted_world_from_camera, recent, matches.landmark_of_feature);
    if (fit.pose.num_inliers < options.min_motion_inliers) continue;
    std::optional<TrackResult> result =
        TrackLocalMap(features, fit.pose.world_from_camera, local, pixel_sigma, options);
    if (result) return result;
  }
  return std::nullopt;
}

std::optional<TrackResult> TrackWithoutPrediction(const Features& features, const LocalMap& local,
                                                  double pixel_sigma,
                                                  const TrackerOptions& options) {
  std::vector<Descriptor> descriptors;
  descriptors.reserve(local.landmarks.size());
  for (const LocalLandmark& landmark : local.landmarks) descriptors.push_back(landmark.descriptor);
  const std::vector<Match> matches = MatchMutually(descriptors, features.descriptors, {});
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> bearings;
  std::vector<double> sigmas;
  for (const Match& match : matches) {
    points.push_back(local.landmarks[match.first].position);
    bearings.push_back(features.bearings[match.second]);
    sigmas.push_back(features.keypoints[match.second].sigma);
  }
  RansacOptions ransac;
  ransac.min_inliers = options.min_motion_inliers;
  const std::optional<AbsolutePose> pose = EstimateAbsolutePose(points, bearings, sigmas, ransac);
  if (!pose) return std::nullopt;
  return TrackLocalMap(features, pose->camera_from_world.Inverse(), local, pixel_sigma, options);
}

}  // namespace orb360
