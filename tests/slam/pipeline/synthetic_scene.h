#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "slam/features/feature_index.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/features/features.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Points with descriptors of their own, and what a camera sees of them: features without images.
struct SyntheticScene {
  struct Point {
    Eigen::Vector3d position;  // world
    Descriptor descriptor;
    double max_range;  // from which it is seen on pyramid level 0
  };
  std::vector<Point> points;
  double sigma = 0.001;  // rad, noise of a bearing on level 0
  RandomGeometry random{7};

  explicit SyntheticScene(int count, double nearest = 2.0, double farthest = 20.0) {
    for (int i = 0; i < count; ++i) {
      Descriptor descriptor;
      for (uint64_t& word : descriptor) {
        word = static_cast<uint64_t>(random.Uniform(0.0, 1.0) * 4294967296.0) << 32 |
               static_cast<uint64_t>(random.Uniform(0.0, 1.0) * 4294967296.0);
      }
      const Eigen::Vector3d position = random.Point(nearest, farthest);
      points.push_back({position, descriptor, position.norm() * random.Uniform(1.0, 3.0)});
    }
  }

  /// Feature i shows point i. `noise`: fraction of sigma that is really added.
  std::shared_ptr<Features> See(const Rigid3& world_from_camera, double noise = 1.0) {
    auto features = std::make_shared<Features>();
    const Rigid3 camera_from_world = world_from_camera.Inverse();
    for (const Point& point : points) {
      const Eigen::Vector3d p = camera_from_world * point.position;
      const int level = std::clamp(PredictLevel(point.max_range, p.norm()), 0, 7);
      const double level_sigma = sigma * std::exp2(level / 4.0);
      const Eigen::Vector3d bearing = random.Noisy(p.normalized(), noise * level_sigma);
      features->bearings.push_back(bearing);
      features->descriptors.push_back(point.descriptor);
      features->colors.push_back({1, 2, 3});
      features->keypoints.push_back({Eigen::Vector2f::Zero(), 0.0f, static_cast<float>(level_sigma),
                                     static_cast<uint8_t>(level), 50});
    }
    IndexFeatures(features.get());
    return features;
  }

  /// A map of `keyframes`, in which each sees the first `num_mapped` points, at their true places.
  Map MakeMap(const std::vector<Rigid3>& keyframes, int num_mapped, double noise = 1.0) {
    Map map;
    for (size_t k = 0; k < keyframes.size(); ++k) {
      map.AddKeyframe(static_cast<int>(k), 0.1 * static_cast<double>(k), keyframes[k],
                      See(keyframes[k], noise));
    }
    for (int i = 0; i < num_mapped; ++i) {
      const LandmarkId id = map.AddLandmark(points[i].position, {1, 2, 3});
      for (size_t k = 0; k < keyframes.size(); ++k) {
        map.AddObservation(id, static_cast<KeyframeId>(k), i);
      }
      map.UpdateAppearance(id);
    }
    return map;
  }
};

/// Poses along a line, `step` apart, turning a little.
inline std::vector<Rigid3> Walk(int count, const Eigen::Vector3d& step) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({ExpSo3(Eigen::Vector3d(0.01, -0.02, 0.03) * i), step * i});
  }
  return poses;
}

}  // namespace orb360
