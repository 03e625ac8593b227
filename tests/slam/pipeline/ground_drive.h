#pragma once

#include <memory>
#include <span>

#include "tests/slam/scale/ground_scene.h"
#include <orb360/slam/geometry/so3.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

inline constexpr double kHeight = 1.5;
inline constexpr double kStep = 1.1;

/// The true pose of keyframe i: a drive along +X, turning a little.
inline Rigid3 TruePose(int i) {
  return {ExpSo3({0.01 * i, 0.02, 3.0 + 0.05 * i}), {kStep * i, 0.0, kHeight}};
}

/// A map of `count` keyframes over asphalt, as large as `scale` says.
inline Map Drive(int count, double scale, const Ground& ground) {
  Map map;
  for (int i = 0; i < count; ++i) {
    Rigid3 pose = TruePose(i);
    const auto image = std::make_shared<const SpherePyramid>(LookAtGround(pose, ground));
    pose.translation *= scale;
    const KeyframeId id = map.AddKeyframe(i, 0.1 * i, pose, std::make_shared<Features>());
    map.keyframe(id).image = image;
  }
  return map;
}

/// Lets all keyframes see the same points of the world, from their true poses: feature i sees point
/// i, and landmark i lies at `scale` times point i.
inline void SeePoints(std::span<const Eigen::Vector3d> points, double scale, Map* map) {
  for (KeyframeId id = 0; id < map->keyframe_end(); ++id) {
    auto features = std::make_shared<Features>();
    for (const Eigen::Vector3d& point : points) {
      features->bearings.push_back((TruePose(id).Inverse() * point).normalized());
      features->keypoints.push_back({Eigen::Vector2f::Zero(), 0.0F, 0.004F, 0, 50});
      features->descriptors.emplace_back();
    }
    map->keyframe(id).features = features;
    map->keyframe(id).landmarks.assign(points.size(), kNoId);
  }
  for (size_t i = 0; i < points.size(); ++i) {
    const LandmarkId landmark = map->AddLandmark(scale * points[i], Color{});
    for (KeyframeId id = 0; id < map->keyframe_end(); ++id) {
      map->AddObservation(landmark, id, static_cast<int>(i));
    }
  }
}

/// Ground whose texture is in heights of the camera.
inline Ground Scaled(const Asphalt& asphalt) {
  return [asphalt](const Eigen::Vector2d& p) { return asphalt(p / kHeight); };
}

}  // namespace orb360
