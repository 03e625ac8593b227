#include "slam/pipeline/initializer.h"

#include <algorithm>
#include <cmath>

#include "slam/features/matching.h"
#include "slam/geometry/essential_matrix.h"
#include "slam/geometry/triangulation.h"
#include "slam/optimization/bearing_residual.h"
#include "slam/optimization/bundle_adjustment.h"

namespace orb360 {
namespace {

struct MatchedViews {
  std::vector<Match> matches;
  std::optional<RelativePose> pose;
};

MatchedViews EstimateMotion(const Features& features1, const Features& features2,
                            std::vector<Match> matches, const InitializerOptions& options) {
  std::vector<Eigen::Vector3d> bearings1;
  std::vector<Eigen::Vector3d> bearings2;
  std::vector<double> sigmas1;
  std::vector<double> sigmas2;
  for (const Match& match : matches) {
    bearings1.push_back(features1.bearings[match.first]);
    bearings2.push_back(features2.bearings[match.second]);
    sigmas1.push_back(features1.keypoints[match.first].sigma);
    sigmas2.push_back(features2.keypoints[match.second].sigma);
  }
  RansacOptions ransac;
  ransac.min_inliers =
      std::max(options.min_landmarks, static_cast<int>(options.min_inlier_ratio * matches.size()));
  std::optional<RelativePose> pose;
  if (static_cast<int>(matches.size()) >= options.min_landmarks) {
    pose = EstimateRelativePose(bearings1, bearings2, sigmas1, sigmas2, ransac);
  }
  return {std::move(matches), std::move(pose)};
}

// Median parallax of the matches that agree with the motion and are near enough to become
// landmarks, radians; 0 where there are too few. Clouds and distant hills have none, however far
// the camera moves, and under an open sky they are the majority.
double MedianParallax(const Features& features1, const Features& features2,
                      const MatchedViews& views, const InitializerOptions& options) {
  std::vector<double> parallaxes;
  for (size_t i = 0; i < views.matches.size(); ++i) {
    if (!views.pose->inliers[i]) continue;
    const double parallax =
        std::acos(std::min(1.0, ParallaxCosine(views.pose->camera1_from_camera2.rotation,
                                               features1.bearings[views.matches[i].first],
                                               features2.bearings[views.matches[i].second])));
    if (parallax > options.min_landmark_parallax) parallaxes.push_back(parallax);
  }
  if (static_cast<int>(parallaxes.size()) < options.min_landmarks) return 0;
  const auto middle = parallaxes.begin() + parallaxes.size() / 2;
  std::nth_element(parallaxes.begin(), middle, parallaxes.end());
  return *middle;
}

// Points and camera 2 refined together; camera 1 is the gauge, and the free scale does no harm to
// Levenberg-Marquardt. Points whose residuals are too large afterwards are dropped.
bool Refine(const Features& features1, const Features& features2, Optimizer optimizer,
            TwoViewMap* map) {
  BundleProblem problem;
  problem.world_from_camera = {Rigid3(), map->world_from_camera2};
  problem.pose_fixed = {1, 0};
  for (size_t i = 0; i < map->points.size(); ++i) {
    const TwoViewMap::Point& point = map->points[i];
    problem.points.push_back(point.position);
    const int index = static_cast<int>(i);
    problem.observations.push_back(
        {0, index, features1.bearings[point.feature1], features1.keypoints[point.feature1].sigma});
    problem.observations.push_back(
        {1, index, features2.bearings[point.feature2], features2.keypoints[point.feature2].sigma});
  }
  if (!SolveBundle({.max_iterations = 20, .optimizer = optimizer}, &problem).usable) return false;
  std::vector<TwoViewMap::Point> kept;
  for (size_t i = 0; i < map->points.size(); ++i) {
    const double worst = std::max(SquaredResidual(problem, problem.observations[2 * i]),
                                  SquaredResidual(problem, problem.observations[2 * i + 1]));
    if (worst > kChiSquared95) continue;
    kept.push_back(map->points[i]);
    kept.back().position = problem.points[i];
  }
  map->world_from_camera2 = problem.world_from_camera[1];
  map->points = std::move(kept);
  return true;
}

}  // namespace

InitializationResult InitializeFromTwoViews(const Features& features1, const Features& features2,
                                            const InitializerOptions& options, Optimizer optimizer,
                                            int num_threads) {
  const MatchOptions matching{.num_threads = num_threads};
  MatchedViews views =
      EstimateMotion(features1, features2,
                     MatchNearby(features1, features2, options.nearby_radius, matching), options);
  if (!views.pose) {
    views = EstimateMotion(features1, features2,
                           MatchMutually(features1.descriptors, features2.descriptors, matching),
                           options);
  }
  InitializationResult result;
  if (!views.pose) return result;
  result.num_inliers = views.pose->num_inliers;
  result.failure = InitializationFailure::kLittleParallax;
  result.turn = views.pose->camera1_from_camera2.rotation;
  const double finest_sigma =
      std::min_element(features1.keypoints.begin(), features1.keypoints.end(),
                       [](const Keypoint& a, const Keypoint& b) { return a.sigma < b.sigma; })
          ->sigma;
  const double min_parallax =
      std::max(options.min_parallax, options.min_parallax_sigmas * finest_sigma);
  if (MedianParallax(features1, features2, views, options) < min_parallax) return result;

  TwoViewMap map;
  map.world_from_camera2 = views.pose->camera1_from_camera2;
  const double max_cosine = std::cos(options.min_landmark_parallax);
  for (size_t i = 0; i < views.matches.size(); ++i) {
    if (!views.pose->inliers[i]) continue;
    const Match& match = views.matches[i];
    const Eigen::Vector3d& bearing1 = features1.bearings[match.first];
    const Eigen::Vector3d& bearing2 = features2.bearings[match.second];
    if (ParallaxCosine(map.world_from_camera2.rotation, bearing1, bearing2) > max_cosine) continue;
    const std::optional<Eigen::Vector3d> point = TriangulateTwoViews(
        map.world_from_camera2, bearing1, bearing2, features1.keypoints[match.first].sigma,
        features2.keypoints[match.second].sigma);
    if (point) map.points.push_back({match.first, match.second, *point});
  }
  if (static_cast<int>(map.points.size()) < options.min_landmarks) return result;
  if (!Refine(features1, features2, optimizer, &map)) return result;
  if (static_cast<int>(map.points.size()) < options.min_landmarks) return result;
  result.map = std::move(map);
  return result;
}

}  // namespace orb360
