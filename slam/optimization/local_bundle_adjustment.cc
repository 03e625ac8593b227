#include "slam/optimization/local_bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "nn/base/statistics.h"
#include "slam/geometry/ground_plane.h"
#include "slam/optimization/bearing_residual.h"

namespace orb360 {
namespace {

// A plane below the camera whose height differs by more than this fraction is not the ground, but
// that of a kerb or a roof.
constexpr double kMaxHeightError = 0.1;
// All ranges of a keyframe together weigh as much as this many independent measurements. About as
// many surfaces stand around a camera, and a network is right or wrong about each as a whole.
constexpr double kIndependentRanges = 5.0;
// A third round of the whole map's adjustment finds next to no further outliers.
constexpr int kGlobalRounds = 2;

// Range, in heights of the camera, beyond which a point 14 degrees under the horizon
// (GroundPlaneOptions) lies at least twice as deep as the ground.
constexpr double kGroundReach = 8.0;

// Standard deviation of the camera's height over the ground from place to place, a fraction of it:
// the road is uneven and the camera bobs. In local bundle adjustment twice as much lets a car
// beside the camera prevail. In the whole map all keyframes together determine the scale well, and
// an uneven road must not bend the path.
constexpr double kLocalReliefSigma = 0.005;
constexpr double kGlobalReliefSigma = 0.03;
// Where the points lie that show a turn, heights of the camera, and the standard deviation of the
// turn beside that of the tiles, rad.
constexpr double kAhead = 0.5;
constexpr double kTurnSigma = 0.006;

// Adds the heights of the camera with index `pose` over the points of the ground around it.
void AddHeights(int pose, const KnownGround& ground, double sigma, BundleProblem* problem) {
  const Rigid3& world_from_camera = problem->world_from_camera[pose];
  const Rigid3 camera_from_world = world_from_camera.Inverse();
  const double squared_reach = std::pow(kGroundReach * ground.camera_height, 2);
  std::vector<int> near;
  std::vector<Eigen::Vector3d> points;  // the near ones, camera frame
  for (size_t p = 0; p < problem->points.size(); ++p) {
    const Eigen::Vector3d& point = problem->points[p];
    if ((point - world_from_camera.translation).squaredNorm() > squared_reach) continue;
    near.push_back(static_cast<int>(p));
    points.push_back(camera_from_world * point);
  }
  const std::optional<GroundPlane> plane =
      FitGroundPlane(points, camera_from_world.rotation * ground.up, {});
  if (!plane || !(std::abs(plane->height / ground.camera_height - 1) < kMaxHeightError)) return;
  // The errors of the heights have the same causes, so that all heights together weigh as much as
  // one measurement.
  const double total = std::reduce(plane->weights.begin(), plane->weights.end());
  for (size_t i = 0; i < plane->points.size(); ++i) {
    problem->heights.push_back({.pose = pose,
                                .point = near[plane->points[i]],
                                .normal = plane->normal,
                                .height = ground.camera_height,
                                .sigma = sigma * std::sqrt(total / plane->weights[i])});
  }
}

// Adds the steps to a keyframe that were measured on the ground. `pose_of`: by keyframe, -1 for
// those that do not take part. Along the motion the point half-way counts, where an error of the
// ground's normal cancels. Across it, where relief shifts nothing, one point ahead and one behind
// tell the direction of the motion and the rotation about the normal.
void AddSteps(const Keyframe& keyframe, const std::vector<int>& pose_of, double camera_height,
              double relief_sigma, BundleProblem* problem) {
  for (const GroundStepFrom& step : keyframe.ground_steps) {
    const int from = pose_of[step.keyframe];
    if (from < 0) continue;
    const auto add = [&](double ahead, const Eigen::Vector3d& direction, double sigma) {
      problem->shared_points.push_back(
          {.pose1 = from,
           .pose2 = pose_of[keyframe.id],
           .point1 = camera_height * (step.point1 + ahead * step.direction1),
           .point2 = camera_height * (step.point2 + ahead * step.direction2),
           .sqrt_information = Eigen::Vector2d::UnitX() * direction.transpose() / sigma});
    };
    add(0, step.direction2, step.ratio * camera_height * std::hypot(step.sigma, relief_sigma));
    const Eigen::Vector3d across = step.up.cross(step.direction2).normalized();
    const double sigma =
        std::sqrt(2.0) * kAhead * camera_height * std::hypot(step.turn_sigma, kTurnSigma);
    add(kAhead, across, sigma);
    add(-kAhead, across, sigma);
  }
}

// Scales the problem about its first fixed pose, so that the cameras have the right mean height
// over the ground. The solver, which moves each point by itself, would need many steps for that.
void RestoreMeanHeight(BundleProblem* problem) {
  constexpr size_t kMinPoses = 5;  // as many poses must see the ground as it takes to find it
  std::set<int> poses;
  double sum_measured = 0;
  double sum_squared = 0;
  for (const BundleProblem::Height& height : problem->heights) {
    const Rigid3& pose = problem->world_from_camera[height.pose];
    const double measured =
        (pose.rotation * height.normal).dot(pose.translation - problem->points[height.point]) /
        height.height;
    const double weight = 1 / (height.sigma * height.sigma);
    sum_measured += weight * measured;
    sum_squared += weight * measured * measured;
    poses.insert(height.pose);
  }
  if (poses.size() < kMinPoses) return;
  const double factor = sum_measured / sum_squared;  // least squares of factor * measured - 1
  const auto fixed = std::ranges::find(problem->pose_fixed, uint8_t{1});
  const Eigen::Vector3d center =
      problem->world_from_camera[fixed - problem->pose_fixed.begin()].translation;
  const auto scale = [&](Eigen::Vector3d* p) { *p = center + factor * (*p - center); };
  for (Rigid3& pose : problem->world_from_camera) scale(&pose.translation);
  for (Eigen::Vector3d& point : problem->points) scale(&point);
  for (BundleProblem::Range& range : problem->ranges) range.range *= factor;
}

// The ranges of one image have a common error of scale. It is estimated and removed, so that the
// ranges tell how the landmarks lie to each other but not how large the world is. The sigmas are
// increased, so that all ranges of an image weigh as much as a few independent measurements.
void LevelRanges(BundleProblem* problem) {
  std::vector<std::vector<size_t>> ranges_of(problem->world_from_camera.size());
  for (size_t i = 0; i < problem->ranges.size(); ++i) {
    ranges_of[problem->ranges[i].pose].push_back(i);
  }
  for (size_t pose = 0; pose < ranges_of.size(); ++pose) {
    if (ranges_of[pose].empty()) continue;
    const Eigen::Vector3d& center = problem->world_from_camera[pose].translation;
    std::vector<double> ratios;
    for (const size_t i : ranges_of[pose]) {
      const BundleProblem::Range& range = problem->ranges[i];
      ratios.push_back((problem->points[range.point] - center).norm() / range.range);
    }
    const double median = Median(ratios);
    const double factor = std::sqrt(std::max(1.0, ratios.size() / kIndependentRanges));
    for (const size_t i : ranges_of[pose]) {
      problem->ranges[i].range *= median;
      problem->ranges[i].sigma *= factor;
    }
  }
}

// The observation of a feature's corner, without alignment.
BundleProblem::Observation CornerObservation(const Keyframe& keyframe, int feature, int pose,
                                             int point) {
  return {.pose = pose,
          .point = point,
          .bearing = keyframe.features->bearings[feature],
          .sigma = keyframe.features->keypoints[feature].sigma};
}

// Builds a problem, solves it and writes the result to the map. Only the landmarks' observations
// from `moving` and `fixed` keyframes take part; the latter do not move. `free_scale`: the fixed
// keyframes do not determine the scale.
void Adjust(std::span<const KeyframeId> moving, std::span<const KeyframeId> fixed,
            std::span<const LandmarkId> landmarks, const BundleOptions& options,
            const std::optional<KnownGround>& ground, double height_sigma, bool free_scale,
            Map* map) {
  BundleProblem problem;
  std::vector<int> pose_of(map->keyframe_end(), -1);
  const auto add_pose = [&](KeyframeId id, bool is_fixed) {
    pose_of[id] = static_cast<int>(problem.world_from_camera.size());
    problem.world_from_camera.push_back(map->keyframe(id).world_from_camera);
    problem.pose_fixed.push_back(is_fixed);
  };
  for (const KeyframeId id : moving) add_pose(id, false);
  for (const KeyframeId id : fixed) add_pose(id, true);

  struct Source {
    LandmarkId landmark;
    KeyframeId keyframe;
  };
  std::vector<Source> sources;  // by observation
  for (const LandmarkId id : landmarks) {
    const Landmark& landmark = map->landmark(id);
    const int point = static_cast<int>(problem.points.size());
    problem.points.push_back(landmark.position);
    for (const Observation& o : landmark.observations) {
      if (pose_of[o.keyframe] < 0) continue;
      const Keyframe& keyframe = map->keyframe(o.keyframe);
      const int pose = pose_of[o.keyframe];
      if (o.aligned_sigma > 0) {
        problem.observations.push_back({.pose = pose,
                                        .point = point,
                                        .bearing = o.aligned_bearing.cast<double>().normalized(),
                                        .sigma = o.aligned_sigma});
      } else {
        problem.observations.push_back(CornerObservation(keyframe, o.feature, pose, point));
      }
      if (const RangePrior prior = keyframe.PriorOf(o.feature); prior.sigma > 0) {
        problem.ranges.push_back(
            {.pose = pose, .point = point, .range = prior.range, .sigma = prior.sigma});
      }
      sources.push_back({id, o.keyframe});
    }
  }
  LevelRanges(&problem);
  for (size_t i = 0; ground && i < moving.size(); ++i) {
    AddHeights(static_cast<int>(i), *ground, height_sigma, &problem);
  }
  if (ground) {
    const double relief_sigma = free_scale ? kGlobalReliefSigma : kLocalReliefSigma;
    for (const KeyframeId id : moving) {
      AddSteps(map->keyframe(id), pose_of, ground->camera_height, relief_sigma, &problem);
    }
    for (const KeyframeId id : fixed) {
      AddSteps(map->keyframe(id), pose_of, ground->camera_height, relief_sigma, &problem);
    }
  }
  if (free_scale) RestoreMeanHeight(&problem);
  if (!SolveBundle(options, &problem).usable) return;

  for (size_t i = 0; i < moving.size(); ++i) {
    map->keyframe(moving[i]).world_from_camera = problem.world_from_camera[i];
  }
  for (size_t i = 0; i < landmarks.size(); ++i) {
    map->landmark(landmarks[i]).position = problem.points[i];
  }
  for (size_t i = 0; i < sources.size(); ++i) {
    BundleProblem::Observation& observed = problem.observations[i];
    if (SquaredResidual(problem, observed) <= kChiSquared95) continue;
    // It may be only the alignment that is wrong.
    Observation& source = *map->landmark(sources[i].landmark).FindObservation(sources[i].keyframe);
    if (source.aligned_sigma > 0) {
      source.aligned_sigma = 0;
      observed = CornerObservation(map->keyframe(source.keyframe), source.feature, observed.pose,
                                   observed.point);
      if (SquaredResidual(problem, observed) <= kChiSquared95) continue;
    }
    map->RemoveObservation(sources[i].landmark, sources[i].keyframe);
  }
  for (const LandmarkId id : landmarks) {
    if (map->landmark(id).observations.size() < 2) map->RemoveLandmark(id);
  }
}

}  // namespace

void AdjustLocally(KeyframeId center, const LocalBundleOptions& options,
                   const std::optional<KnownGround>& ground, Map* map) {
  std::vector<KeyframeId> moving = {center};
  for (const Map::Covisible& neighbour :
       map->FindCovisible(map->keyframe(center).landmarks, options.min_shared, center)) {
    if (static_cast<int>(moving.size()) == options.max_keyframes) break;
    moving.push_back(neighbour.keyframe);
  }
  std::vector<LandmarkId> landmarks;
  for (const KeyframeId id : moving) {
    const std::vector<LandmarkId>& seen = map->keyframe(id).landmarks;
    std::copy_if(seen.begin(), seen.end(), std::back_inserter(landmarks),
                 [](LandmarkId l) { return l != kNoId; });
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());

  std::vector<KeyframeId> fixed;
  for (const Map::Covisible& observer : map->FindCovisible(landmarks, 1)) {
    if (static_cast<int>(fixed.size()) == options.max_fixed_keyframes) break;
    if (std::find(moving.begin(), moving.end(), observer.keyframe) == moving.end()) {
      fixed.push_back(observer.keyframe);
    }
  }
  // Fixed poses hold the gauge; in a small map these are its oldest. Steps over the ground hold the
  // scale, or else it takes a second one.
  const auto is_moving = [&](KeyframeId id) { return std::ranges::count(moving, id) > 0; };
  const bool has_scale = ground && std::ranges::any_of(moving, [&](KeyframeId id) {
                           return std::ranges::any_of(map->keyframe(id).ground_steps, is_moving,
                                                      &GroundStepFrom::keyframe);
                         });
  const size_t min_fixed = has_scale ? 1 : 2;
  while (fixed.size() < min_fixed && moving.size() > 1) {
    const auto oldest = std::min_element(moving.begin(), moving.end());
    fixed.push_back(*oldest);
    moving.erase(oldest);
  }
  Adjust(moving, fixed, landmarks,
         {.max_iterations = options.max_iterations, .optimizer = options.optimizer}, ground,
         options.height_sigma, false, map);
}

void AdjustGlobally(int max_iterations, const std::optional<KnownGround>& ground,
                    double height_sigma, Map* map, Optimizer optimizer) {
  const std::vector<KeyframeId> keyframes = map->KeyframeIds();
  if (keyframes.size() < 2) return;
  const std::span<const KeyframeId> all(keyframes);
  for (int round = 0; round < kGlobalRounds; ++round) {
    std::vector<LandmarkId> landmarks;
    for (LandmarkId id = 0; id < map->landmark_end(); ++id) {
      if (map->HasLandmark(id)) landmarks.push_back(id);
    }
    Adjust(all.subspan(1), all.first(1), landmarks,
           {.max_iterations = max_iterations, .loss = BundleLoss::kArctan, .optimizer = optimizer},
           ground, height_sigma, true, map);
  }
}

}  // namespace orb360
