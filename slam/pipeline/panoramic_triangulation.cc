#include "slam/pipeline/panoramic_triangulation.h"

#include <algorithm>
#include <cmath>

#include "slam/features/epipolar_scan.h"
#include "slam/features/hamming.h"
#include "slam/geometry/essential_matrix.h"
#include "slam/geometry/triangulation.h"
#include "slam/optimization/bearing_residual.h"

namespace orb360 {
namespace {

// The features of a keyframe whose corners have no landmark yet.
struct FreeFeatures {
  std::vector<int> index;
  BearingColumns columns;
  std::vector<uint8_t> is_mapped;  // by corner
};

FreeFeatures CollectFree(const Keyframe& keyframe) {
  std::vector<int> index;
  std::vector<Eigen::Vector3d> bearings;
  std::vector<double> sigmas;
  std::vector<uint8_t> is_mapped = FindMappedCorners(keyframe);
  for (int f = 0; f < keyframe.features->size(); ++f) {
    if (is_mapped[keyframe.features->corners[f]] || !keyframe.features->keypoints[f].is_corner()) {
      continue;
    }
    index.push_back(f);
    bearings.push_back(keyframe.features->bearings[f]);
    sigmas.push_back(keyframe.features->keypoints[f].sigma);
  }
  return {std::move(index), BearingColumns(bearings, sigmas), std::move(is_mapped)};
}

struct EpipolarMatch {
  int feature2 = -1;
  int distance = NearestTwo::kNone;
};

// Removes the candidates of keyframe 2 whose completed range contradicts the range that the match
// would give. This leaves fewer competing candidates and fewer wrong matches.
void RemoveByRange(const EpipolarArc& arc, double baseline, const Keyframe& keyframe2,
                   double max_sigmas, std::vector<int>* candidates) {
  if (keyframe2.range_priors.empty()) return;
  const Features& features2 = *keyframe2.features;
  // The angle at camera 1 between the point and camera 2.
  const double sine1 = arc.infinity.cross(arc.epipole).norm();
  std::erase_if(*candidates, [&](int f2) {
    const RangePrior& prior = keyframe2.range_priors[f2];
    if (prior.sigma == 0) return false;
    const double parallax = AngleBetween(arc.infinity, features2.bearings[f2]);
    const double noise = std::sqrt(arc.variance + std::pow(features2.keypoints[f2].sigma, 2));
    // The range follows from the law of sines; its error is that of the parallax.
    const double range = baseline * sine1 / std::max(std::sin(parallax), noise);
    const double sigma = std::hypot(prior.sigma, noise / std::max(parallax, noise));
    return std::abs(std::log(range / prior.range)) > max_sigmas * sigma;
  });
}

// Returns the best match in keyframe 2 for each free feature of keyframe 1.
std::vector<EpipolarMatch> MatchEpipolar(const Keyframe& keyframe1, const FreeFeatures& free1,
                                         const Keyframe& keyframe2, const FreeFeatures& free2,
                                         const Rigid3& camera1_from_camera2,
                                         const TriangulationOptions& options) {
  const Eigen::Matrix3d essential = EssentialMatrix(camera1_from_camera2);
  const Eigen::Quaterniond camera2_from_camera1 = camera1_from_camera2.rotation.conjugate();
  const Features& features1 = *keyframe1.features;
  const Features& features2 = *keyframe2.features;
  EpipolarArc arc;
  arc.epipole = EpipoleInCamera2(camera1_from_camera2);
  arc.max_sigmas = options.max_plane_sigmas;
  arc.max_parallax = options.max_parallax;
  arc.max_epipole_cosine = std::cos(options.min_epipole_angle);
  std::vector<EpipolarMatch> matches(free1.index.size());
  std::vector<int> candidates;
  for (size_t i = 0; i < free1.index.size(); ++i) {
    const int f1 = free1.index[i];
    const Eigen::Vector3d& bearing1 = features1.bearings[f1];
    const double sigma1 = features1.keypoints[f1].sigma;
    arc.normal = EpipolarPlaneNormal(essential, bearing1);
    arc.infinity = camera2_from_camera1 * bearing1;
    arc.variance = sigma1 * sigma1;
    FindOnArc(free2.columns, arc, &candidates);
    for (int& candidate : candidates) candidate = free2.index[candidate];
    RemoveByRange(arc, camera1_from_camera2.translation.norm(), keyframe2, options.max_range_sigmas,
                  &candidates);
    const NearestTwo nearest =
        FindNearestTwo(features1.descriptors[f1], features2.descriptors, candidates);
    if (nearest.best_distance > options.max_distance) continue;
    const bool rivalled =
        nearest.second_index >= 0 && features2.keypoints[nearest.second_index].level ==
                                         features2.keypoints[nearest.best_index].level;
    if (rivalled && nearest.best_distance > options.ratio * nearest.second_distance) continue;
    matches[i] = {nearest.best_index, nearest.best_distance};
  }
  return matches;
}

// Returns the triangulated point in the frame of camera 1 if it passes all checks.
std::optional<Eigen::Vector3d> MakePoint(const Features& features1, int f1,
                                         const Features& features2, int f2,
                                         const Rigid3& camera1_from_camera2,
                                         const TriangulationOptions& options) {
  const Keypoint& keypoint1 = features1.keypoints[f1];
  const Keypoint& keypoint2 = features2.keypoints[f2];
  const Eigen::Vector3d& bearing1 = features1.bearings[f1];
  const Eigen::Vector3d& bearing2 = features2.bearings[f2];
  const double sigma = std::hypot(keypoint1.sigma, keypoint2.sigma);
  const double parallax = AngleBetween(bearing1, camera1_from_camera2.rotation * bearing2);
  if (parallax < std::max(options.min_parallax, options.min_parallax_sigmas * sigma)) {
    return std::nullopt;
  }
  std::optional<Eigen::Vector3d> point = TriangulateTwoViews(
      camera1_from_camera2, bearing1, bearing2, keypoint1.sigma, keypoint2.sigma);
  if (!point) return std::nullopt;
  const Eigen::Vector3d point2 = camera1_from_camera2.Inverse() * *point;
  const double error1 = AngleBetween(*point, bearing1) / keypoint1.sigma;
  const double error2 = AngleBetween(point2, bearing2) / keypoint2.sigma;
  if (std::max(error1, error2) > std::sqrt(kChiSquared95)) return std::nullopt;
  // The size of a patch in an image is inversely proportional to its range.
  const double scales = keypoint1.sigma / keypoint2.sigma;
  const double ranges = point2.norm() / point->norm();
  const double ratio = ranges / scales;
  if (ratio > options.max_scale_ratio || ratio < 1.0 / options.max_scale_ratio) {
    return std::nullopt;
  }
  return point;
}

}  // namespace

std::vector<LandmarkId> TriangulateNewLandmarks(KeyframeId id, const TriangulationOptions& options,
                                                Map* map) {
  std::vector<Map::Covisible> neighbours = map->FindCovisible(map->keyframe(id).landmarks, 1, id);
  if (static_cast<int>(neighbours.size()) > options.max_neighbours) {
    neighbours.resize(options.max_neighbours);
  }
  std::vector<LandmarkId> created;
  for (const Map::Covisible& neighbour : neighbours) {
    const Keyframe& keyframe1 = map->keyframe(id);
    const Keyframe& keyframe2 = map->keyframe(neighbour.keyframe);
    const Rigid3 camera1_from_camera2 =
        keyframe1.world_from_camera.Inverse() * keyframe2.world_from_camera;
    if (camera1_from_camera2.translation.norm() <
        options.min_baseline * map->MedianRange(neighbour.keyframe)) {
      continue;
    }
    FreeFeatures free1 = CollectFree(keyframe1);
    FreeFeatures free2 = CollectFree(keyframe2);
    const std::vector<EpipolarMatch> matches =
        MatchEpipolar(keyframe1, free1, keyframe2, free2, camera1_from_camera2, options);
    // A feature of keyframe 2 is matched with the nearest descriptor only.
    std::vector<int> owner(keyframe2.features->size(), -1);
    for (size_t i = 0; i < matches.size(); ++i) {
      const int f2 = matches[i].feature2;
      if (f2 >= 0 && (owner[f2] < 0 || matches[i].distance < matches[owner[f2]].distance)) {
        owner[f2] = static_cast<int>(i);
      }
    }
    for (size_t i = 0; i < matches.size(); ++i) {
      const int f1 = free1.index[i];
      const int f2 = matches[i].feature2;
      if (f2 < 0 || owner[f2] != static_cast<int>(i)) continue;
      uint8_t& is_mapped1 = free1.is_mapped[keyframe1.features->corners[f1]];
      uint8_t& is_mapped2 = free2.is_mapped[keyframe2.features->corners[f2]];
      if (is_mapped1 || is_mapped2) continue;  // The corner has a landmark from another level.
      const std::optional<Eigen::Vector3d> point = MakePoint(
          *keyframe1.features, f1, *keyframe2.features, f2, camera1_from_camera2, options);
      if (!point) continue;
      const std::vector<Color>& colors = keyframe1.features->colors;
      const LandmarkId landmark = map->AddLandmark(keyframe1.world_from_camera * *point,
                                                   colors.empty() ? Color{} : colors[f1]);
      map->AddObservation(landmark, id, f1);
      map->AddObservation(landmark, neighbour.keyframe, f2);
      map->UpdateAppearance(landmark);
      is_mapped1 = is_mapped2 = 1;
      created.push_back(landmark);
    }
  }
  return created;
}

}  // namespace orb360
