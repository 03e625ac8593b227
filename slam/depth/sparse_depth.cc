#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/geometry/bearing.h"
#include <orb360/slam/depth/sparse_depth.h>
#include <orb360/slam/features/sphere_grid.h>

namespace orb360 {
namespace {

struct Projection {
  LandmarkId landmark;
  Eigen::Vector3d bearing;
  double range;
  bool seen;  // by the keyframe itself
};

std::vector<LandmarkId> LandmarksAround(const Map& map, const Keyframe& keyframe,
                                        int num_neighbours) {
  std::vector<LandmarkId> ids = keyframe.landmarks;
  std::vector<Map::Covisible> neighbours = map.FindCovisible(keyframe.landmarks, 1, keyframe.id);
  if (static_cast<int>(neighbours.size()) > num_neighbours) neighbours.resize(num_neighbours);
  for (const Map::Covisible& neighbour : neighbours) {
    const std::vector<LandmarkId>& seen = map.keyframe(neighbour.keyframe).landmarks;
    ids.insert(ids.end(), seen.begin(), seen.end());
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  if (!ids.empty() && ids.front() == kNoId) ids.erase(ids.begin());
  return ids;
}

// Returns for each projection whether a clearly nearer one lies in almost the same direction.
std::vector<bool> FindHidden(const std::vector<Projection>& projections,
                             const SparseDepthOptions& options) {
  std::vector<Eigen::Vector3d> bearings;
  bearings.reserve(projections.size());
  for (const Projection& p : projections) bearings.push_back(p.bearing);
  const SphereGrid grid(bearings);
  const double min_cosine = std::cos(options.occlusion_angle);
  std::vector<bool> hidden(projections.size(), false);
  std::vector<int> near;
  for (size_t i = 0; i < projections.size(); ++i) {
    if (projections[i].seen) continue;
    near.clear();
    grid.Query(bearings[i], options.occlusion_angle, &near);
    hidden[i] = std::any_of(near.begin(), near.end(), [&](int j) {
      return bearings[i].dot(bearings[j]) > min_cosine &&
             projections[j].range < options.occlusion_ratio * projections[i].range;
    });
  }
  return hidden;
}

}  // namespace

double RangeError(const Map& map, const Landmark& landmark) {
  const auto toward_camera = [&](const Observation& o) -> Eigen::Vector3d {
    return (map.PoseOf(o.keyframe).translation - landmark.position).normalized();
  };
  const auto farthest_from = [&](const Eigen::Vector3d& direction) {
    std::pair<double, Eigen::Vector3d> best{1.0, direction};  // with the cosine
    for (const Observation& o : landmark.observations) {
      const Eigen::Vector3d other = toward_camera(o);
      if (const double cosine = direction.dot(other); cosine < best.first) best = {cosine, other};
    }
    return best.second;
  };
  // The angle between the observation farthest from the first one and the observation farthest from
  // that. It is within a factor of two of the widest angle and takes linear time.
  const Eigen::Vector3d end = farthest_from(toward_camera(landmark.observations.front()));
  const double parallax = AngleBetween(end, farthest_from(end));
  if (!(parallax > 0)) return std::numeric_limits<double>::infinity();

  double squared_noise = 0;
  double squared_residuals = 0;
  for (const Observation& o : landmark.observations) {
    const Keyframe& keyframe = map.keyframe(o.keyframe);
    const double sigma = keyframe.features->keypoints[o.feature].sigma;
    const Eigen::Vector3d observed =
        keyframe.world_from_camera.rotation * keyframe.features->bearings[o.feature];
    squared_noise += sigma * sigma;
    squared_residuals += (observed + toward_camera(o)).squaredNorm();  // of the chord
  }
  const double count = static_cast<double>(landmark.observations.size());
  // A residual has two components of noise.
  const double squared = std::max(squared_noise, 0.5 * squared_residuals) / count;
  return std::sqrt(2.0 * squared / count) / std::sin(std::min(parallax, 1.5));
}

double SparseConfidence(double relative_error, const SparseDepthOptions& options) {
  const double error = relative_error / options.half_confidence_error;
  return 1.0 / (1.0 + error * error);
}

std::vector<SparsePoint> ProjectLandmarks(const Map& map, KeyframeId id,
                                          const EquirectangularCamera& camera,
                                          const SparseDepthOptions& options) {
  return ProjectLandmarks(map, id, map.keyframe(id).world_from_camera, camera, options);
}

std::vector<SparsePoint> ProjectLandmarks(const Map& map, KeyframeId near,
                                          const Rigid3& world_from_camera,
                                          const EquirectangularCamera& camera,
                                          const SparseDepthOptions& options) {
  const Keyframe& keyframe = map.keyframe(near);
  const bool is_keyframe = world_from_camera.translation == keyframe.world_from_camera.translation;
  const Rigid3 camera_from_world = world_from_camera.Inverse();
  std::vector<Projection> projections;
  for (const LandmarkId landmark_id : LandmarksAround(map, keyframe, options.num_neighbours)) {
    const Landmark& landmark = map.landmark(landmark_id);
    if (landmark.found < options.min_found_fraction * landmark.visible) continue;
    const Eigen::Vector3d point = camera_from_world * landmark.position;
    const double range = point.norm();
    if (!(range > 0)) continue;
    const bool seen = is_keyframe && landmark.FindObservation(near) != nullptr;
    projections.push_back({landmark_id, point / range, range, seen});
  }
  const std::vector<bool> hidden = FindHidden(projections, options);

  std::vector<SparsePoint> points;
  cv::Mat nearest(camera.height(), camera.width(), CV_32S, cv::Scalar(-1));  // index into points
  for (size_t i = 0; i < projections.size(); ++i) {
    if (hidden[i]) continue;
    const Projection& projection = projections[i];
    const double confidence =
        SparseConfidence(RangeError(map, map.landmark(projection.landmark)), options);
    if (!(confidence >= options.min_confidence)) continue;
    const Eigen::Vector2d pixel = camera.Project(projection.bearing);
    int& slot = nearest.at<int>(std::min(static_cast<int>(pixel.y()), camera.height() - 1),
                                std::min(static_cast<int>(pixel.x()), camera.width() - 1));
    const SparsePoint point{projection.landmark, pixel, projection.range, confidence};
    if (slot < 0) {
      slot = static_cast<int>(points.size());
      points.push_back(point);
    } else if (point.range < points[slot].range) {
      points[slot] = point;
    }
  }
  std::sort(points.begin(), points.end(),
            [](const SparsePoint& a, const SparsePoint& b) { return a.landmark < b.landmark; });
  return points;
}

SparseDepth RenderSparseDepth(const std::vector<SparsePoint>& points,
                              const EquirectangularCamera& camera) {
  SparseDepth images{cv::Mat::zeros(camera.height(), camera.width(), CV_32F),
                     cv::Mat::zeros(camera.height(), camera.width(), CV_32F)};
  for (const SparsePoint& point : points) {
    const int x = std::min(static_cast<int>(point.pixel.x()), camera.width() - 1);
    const int y = std::min(static_cast<int>(point.pixel.y()), camera.height() - 1);
    images.range.at<float>(y, x) = static_cast<float>(point.range);
    images.confidence.at<float>(y, x) = static_cast<float>(point.confidence);
  }
  return images;
}

}  // namespace orb360
