#include "slam/pipeline/ground.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>

namespace orb360 {
namespace {

constexpr int kKeyframes = 20;       // from the first on: the place where the world is levelled
constexpr double kMinBelow = 0.35;   // rad under the horizon: near enough to be measured well
constexpr double kMaxTilt = 0.7854;  // rad, of the camera against the ground
constexpr int kSamples = 500;
// Points within this share of the camera's height belong to the plane.
constexpr double kTolerance = 0.08;
constexpr int kMinPoints = 40;
constexpr double kMinShare = 0.25;  // of the points below, that a ground must hold

struct Plane {
  Eigen::Vector3d normal;  // unit
  double offset;           // normal . p = offset
};

std::vector<Eigen::Vector3d> PointsBelow(const Map& map, std::span<const KeyframeId> keyframes) {
  std::vector<LandmarkId> ids;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.keyframe(id);
    for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
      const bool below = keyframe.features->bearings[f].z() < -std::sin(kMinBelow);
      if (below && keyframe.landmarks[f] != kNoId) ids.push_back(keyframe.landmarks[f]);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<Eigen::Vector3d> points;
  points.reserve(ids.size());
  for (const LandmarkId id : ids) points.push_back(map.landmark(id).position);
  return points;
}

Plane FitPlane(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

std::vector<Eigen::Vector3d> PointsOn(const Plane& plane, double camera_height,
                                      const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector3d> on;
  std::copy_if(points.begin(), points.end(), std::back_inserter(on), [&](const auto& p) {
    return std::abs(plane.normal.dot(p) - plane.offset) < kTolerance * camera_height;
  });
  return on;
}

}  // namespace

std::optional<Eigen::Vector3d> EstimateUp(const Map& map) {
  std::vector<KeyframeId> keyframes = map.KeyframeIds();
  if (keyframes.empty()) return std::nullopt;
  if (keyframes.size() > kKeyframes) keyframes.resize(kKeyframes);
  const std::vector<Eigen::Vector3d> points = PointsBelow(map, keyframes);
  if (static_cast<int>(points.size()) < kMinPoints) return std::nullopt;
  Eigen::Vector3d camera_up = Eigen::Vector3d::Zero();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const KeyframeId id : keyframes) {
    const Rigid3& pose = map.keyframe(id).world_from_camera;
    camera_up += pose.rotation * Eigen::Vector3d::UnitZ();
    center += pose.translation / static_cast<double>(keyframes.size());
  }
  camera_up.normalize();

  std::mt19937 random(1);
  std::vector<Eigen::Vector3d> best;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d& a = points[random() % points.size()];
    const Eigen::Vector3d& b = points[random() % points.size()];
    const Eigen::Vector3d& c = points[random() % points.size()];
    Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    if (normal.dot(camera_up) < 0) normal = -normal;
    if (!(normal.dot(camera_up) > std::cos(kMaxTilt))) continue;
    const Plane plane{normal, normal.dot(a)};
    const double height = normal.dot(center) - plane.offset;
    if (!(height > 0)) continue;
    std::vector<Eigen::Vector3d> on = PointsOn(plane, height, points);
    if (on.size() > best.size()) best = std::move(on);
  }
  if (static_cast<int>(best.size()) < kMinPoints ||
      static_cast<double>(best.size()) < kMinShare * static_cast<double>(points.size())) {
    return std::nullopt;
  }
  const Plane plane = FitPlane(best);
  return plane.normal.dot(camera_up) < 0 ? Eigen::Vector3d(-plane.normal) : plane.normal;
}

}  // namespace orb360
