#include "slam/pipeline/tracker.h"

#include <cmath>

#include "slam/features/matching.h"
#include "slam/geometry/absolute_pose.h"
#include "slam/geometry/triangulation.h"
#include "slam/optimization/pose_refinement.h"
#include "slam/pipeline/frame_motion.h"
#include "slam/pipeline/projection_search.h"

namespace orb360 {
namespace {

// Matches of features of a frame with landmarks of a list, and the pose that follows from them.
struct PoseFit {
  RefinedPose pose;
  std::vector<int> feature;   // by inlier
  std::vector<int> landmark;  // by inlier, index into the list
};

PoseFit FitPose(const Features& features, const Rigid3& initial,
                std::span<const LocalLandmark> landmarks,
                const std::vector<int>& landmark_of_feature,
                const std::optional<PositionPrior>& prior) {
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
  fit.pose = RefinePose(initial, observations, prior);
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

// Refines the pose again with the provisional points of the local map in addition (completed depth
// of the reference keyframe). `fit` contains the inliers among the landmarks of a list.
Rigid3 RefineWithProvisional(const Features& features, const PoseFit& fit, const LocalMap& local,
                             const ProjectionSearchOptions& search,
                             const std::optional<PositionPrior>& prior) {
  const Rigid3& start = fit.pose.world_from_camera;
  if (local.provisional.empty()) return start;
  std::vector<PoseObservation> observations;
  std::vector<uint8_t> taken(features.size(), 0);
  for (size_t i = 0; i < fit.feature.size(); ++i) {
    const int f = fit.feature[i];
    taken[f] = 1;
    observations.push_back({local.landmarks[fit.landmark[i]].position, features.bearings[f],
                            features.keypoints[f].sigma});
  }
  std::vector<LocalLandmark> points;
  points.reserve(local.provisional.size());
  for (const ProvisionalPoint& point : local.provisional) points.push_back(point.appearance);
  const ProjectionMatches matches = SearchByProjection(features, start, points, taken, search);
  for (int f = 0; f < features.size(); ++f) {
    const int p = matches.landmark_of_feature[f];
    if (p < 0) continue;
    // Seen from this camera, the error of the range is multiplied by the parallax.
    const double parallax = ParallaxAngle(points[p].position, start.translation,
                                          local.world_from_reference.translation);
    const double moved = parallax * local.provisional[p].range_sigma;
    const double sigma = std::hypot(features.keypoints[f].sigma,
                                    static_cast<double>(local.provisional[p].bearing_sigma), moved);
    observations.push_back({points[p].position, features.bearings[f], sigma});
  }
  return RefinePose(start, observations, prior).world_from_camera;
}

struct LocalFit {
  TrackResult result;
  double support = 0;       // as in RefinedPose
  double inlier_ratio = 0;  // as in RefinedPose, of the matches with the local map
};

// Tracks the whole local map, starting from a pose that is accurate to a few standard deviations.
std::optional<LocalFit> TrackLocalMap(const Features& features, const Rigid3& initial,
                                      const LocalMap& local, double pixel_sigma,
                                      const TrackerOptions& options,
                                      const std::optional<PositionPrior>& prior, int num_threads) {
  const ProjectionSearchOptions search{.radius = options.local_radius_sigmas * pixel_sigma,
                                       .scale_radius = true,
                                       .ratio = 0.8,
                                       .num_threads = num_threads};
  const ProjectionMatches matches =
      SearchByProjection(features, initial, local.landmarks, {}, search);
  const PoseFit fit =
      FitPose(features, initial, local.landmarks, matches.landmark_of_feature, prior);
  if (fit.pose.num_inliers < options.min_inliers) return std::nullopt;
  TrackResult result{RefineWithProvisional(features, fit, local, search, prior),
                     std::vector<LandmarkId>(features.size(), kNoId),
                     fit.pose.num_inliers,
                     {}};
  for (size_t i = 0; i < fit.feature.size(); ++i) {
    result.landmarks[fit.feature[i]] = local.landmarks[fit.landmark[i]].id;
  }
  for (size_t l = 0; l < local.landmarks.size(); ++l) {
    if (matches.expected[l]) result.expected.push_back(local.landmarks[l].id);
  }
  return LocalFit{std::move(result), fit.pose.support, fit.pose.inlier_ratio};
}

// Estimates the pose from the last frame's landmarks, starting from the predicted pose.
std::optional<Rigid3> FollowPrediction(const Features& features, const Rigid3& predicted,
                                       const TrackedFrame& last, const LocalMap& local,
                                       const TrackerOptions& options,
                                       const std::optional<PositionPrior>& prior, int num_threads) {
  std::vector<LocalLandmark> recent;
  for (const LandmarkId id : last.landmarks) {
    const LocalLandmark* landmark = id == kNoId ? nullptr : local.Find(id);
    if (landmark != nullptr) recent.push_back(*landmark);
  }
  const ProjectionMatches matches =
      SearchByProjection(features, predicted, recent, {},
                         {.radius = options.motion_radius, .num_threads = num_threads});
  if (matches.num_matches < options.min_motion_inliers) return std::nullopt;
  const PoseFit fit = FitPose(features, predicted, recent, matches.landmark_of_feature, prior);
  if (fit.pose.num_inliers < options.min_motion_inliers) return std::nullopt;
  return fit.pose.world_from_camera;
}

// Estimates the pose from features matched with landmarks of the list, some of them wrongly.
std::optional<Rigid3> EstimatePose(const Features& features,
                                   std::span<const LocalLandmark* const> landmarks,
                                   std::span<const int> paired, const TrackerOptions& options) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> bearings;
  std::vector<double> sigmas;
  for (size_t i = 0; i < paired.size(); ++i) {
    points.push_back(landmarks[i]->position);
    bearings.push_back(features.bearings[paired[i]]);
    sigmas.push_back(features.keypoints[paired[i]].sigma);
  }
  RansacOptions ransac;
  ransac.min_inliers = options.min_motion_inliers;
  const std::optional<AbsolutePose> pose = EstimateAbsolutePose(points, bearings, sigmas, ransac);
  if (!pose) return std::nullopt;
  return pose->camera_from_world.Inverse();
}

// Estimates the pose from landmarks of the last frame, matched from feature to feature, for any
// motion.
std::optional<Rigid3> FollowLandmarks(const Features& features, const TrackedFrame& last,
                                      const LocalMap& local, std::span<const Match> matches,
                                      const TrackerOptions& options) {
  std::vector<const LocalLandmark*> landmarks;
  std::vector<int> paired;
  for (const Match& match : matches) {
    const LandmarkId id = last.landmarks[match.first];
    const LocalLandmark* landmark = id == kNoId ? nullptr : local.Find(id);
    if (landmark == nullptr) continue;
    landmarks.push_back(landmark);
    paired.push_back(match.second);
  }
  return EstimatePose(features, landmarks, paired, options);
}

}  // namespace

std::optional<TrackResult> TrackFromPrediction(const Features& features,
                                               const Rigid3& predicted_world_from_camera,
                                               const TrackedFrame& last, const LocalMap& local,
                                               double pixel_sigma, const TrackerOptions& options,
                                               const std::optional<PositionPrior>& prior,
                                               int num_threads) {
  std::vector<Match> matches;  // with the last frame, found when they are first needed
  const auto find_start = [&](int attempt) {
    if (attempt == 0) {
      return FollowPrediction(features, predicted_world_from_camera, last, local, options, prior,
                              num_threads);
    }
    if (attempt == 1) {
      matches = MatchNearby(*last.features, features, options.nearby_radius,
                            {.num_threads = num_threads});
      return FollowLandmarks(features, last, local, matches, options);
    }
    return PoseFromMotion(features, last, local, matches);
  };
  std::optional<LocalFit> best;
  constexpr int kAttempts = 3;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::optional<Rigid3> start = find_start(attempt);
    if (!start) continue;
    std::optional<LocalFit> fit =
        TrackLocalMap(features, *start, local, pixel_sigma, options, prior, num_threads);
    if (!fit) continue;
    const bool convinces = fit->inlier_ratio >= options.min_inlier_ratio;
    if (!best || fit->support > best->support) best = std::move(fit);
    if (convinces) break;
  }
  if (!best) return std::nullopt;
  return std::move(best->result);
}

std::optional<TrackResult> TrackWithoutPrediction(const Features& features, const LocalMap& local,
                                                  double pixel_sigma, const TrackerOptions& options,
                                                  int num_threads) {
  std::vector<Descriptor> descriptors;
  descriptors.reserve(local.landmarks.size());
  for (const LocalLandmark& landmark : local.landmarks) descriptors.push_back(landmark.descriptor);
  const std::vector<Match> matches =
      MatchMutually(descriptors, features.descriptors, {.num_threads = num_threads});
  std::vector<const LocalLandmark*> landmarks;
  std::vector<int> paired;
  for (const Match& match : matches) {
    landmarks.push_back(&local.landmarks[match.first]);
    paired.push_back(match.second);
  }
  const std::optional<Rigid3> start = EstimatePose(features, landmarks, paired, options);
  if (!start) return std::nullopt;
  std::optional<LocalFit> fit =
      TrackLocalMap(features, *start, local, pixel_sigma, options, std::nullopt, num_threads);
  if (!fit) return std::nullopt;
  return std::move(fit->result);
}

}  // namespace orb360
