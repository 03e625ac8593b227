#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include "slam/features/feature_index.h"
#include "slam/features/sphere_pyramid.h"
#include "slam/geometry/bearing.h"
#include "tests/slam/geometry/box_room.h"
#include <orb360/slam/map/map.h>

namespace orb360 {

inline const EquirectangularCamera kPatchCamera(1024, 512);

inline std::shared_ptr<const SpherePyramid> ImageOf(const BoxRoom& room, const Rigid3& pose) {
  cv::Mat gray;
  cv::cvtColor(room.Render(kPatchCamera, pose), gray, cv::COLOR_BGR2GRAY);
  auto image = std::make_shared<SpherePyramid>();
  BuildSpherePyramid(gray, 8, image.get());
  return image;
}

/// Keyframes in a textured room, with corners found off by half a pixel.
struct PatchScene {
  BoxRoom room{{6.0, 5.0, 3.0}, 8};
  std::mt19937 random{5};
  Map map;
  std::vector<Eigen::Vector3d> shown;  // by landmark: the point in the middle of its patch
  uint8_t level = 0;                   // on which features are found

  /// Points on the walls that look like corners from the origin.
  PatchScene() {
    cv::Mat gray;
    cv::cvtColor(room.Render(kPatchCamera, {}), gray, cv::COLOR_BGR2GRAY);
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(gray(cv::Rect(0, 130, 1024, 252)), corners, 150, 0.1, 15);
    for (const cv::Point2f& corner : corners) {
      const Eigen::Vector3d ray = kPatchCamera.Bearing({corner.x + 0.5, corner.y + 130.5});
      shown.push_back(room.Range({0, 0, 0}, ray) * ray);
      map.AddLandmark(shown.back(), {});
    }
  }

  double Uniform(double low, double high) {
    return low + (high - low) * (random() + 0.5) / 4294967296.0;
  }

  /// Sees all landmarks, landmark l at feature l; with `corners`, only that many of the first.
  KeyframeId AddKeyframe(const Rigid3& pose, bool with_image, size_t corners = SIZE_MAX) {
    auto features = std::make_shared<Features>();
    for (size_t i = 0; i < std::min(shown.size(), corners); ++i) {
      const Eigen::Vector3d seen = pose.Inverse() * shown[i];
      const Eigen::Vector3d wrong = Eigen::Vector3d(Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1))
                                        .cross(seen.normalized())
                                        .normalized();
      const double off = map.num_keyframes() == 0 ? 0 : kPatchCamera.AngleOfPixels(0.5);
      const double sigma = kPatchCamera.AngleOfPixels(0.7 * RangeAtLevelZero(1, level));
      features->keypoints.push_back(
          {Eigen::Vector2f::Zero(), 0.0F, static_cast<float>(sigma), level, 50});
      features->bearings.push_back((seen.normalized() + off * wrong).normalized());
      features->descriptors.push_back({i, i, i, i});
    }
    IndexFeatures(features.get());
    const KeyframeId id =
        map.AddKeyframe(map.num_keyframes(), 0.1 * map.num_keyframes(), pose, features);
    if (with_image) map.keyframe(id).image = ImageOf(room, pose);
    for (LandmarkId l = 0; l < features->size(); ++l) {
      map.AddObservation(l, id, l);
      map.UpdateAppearance(l);
    }
    return id;
  }

  /// Median angle between what the keyframe shows and where it is taken to be, pixels; `fraction`:
  /// of the observations that are aligned.
  double Error(KeyframeId id, bool aligned, double* fraction = nullptr) const {
    std::vector<double> errors;
    const Keyframe& keyframe = map.keyframe(id);
    for (LandmarkId l = 0; l < map.landmark_end(); ++l) {
      for (const Observation& o : map.landmark(l).observations) {
        if (o.keyframe != id || (aligned && o.aligned_sigma == 0)) continue;
        const Eigen::Vector3d bearing = aligned ? Eigen::Vector3d(o.aligned_bearing.cast<double>())
                                                : keyframe.features->bearings[o.feature];
        errors.push_back(AngleBetween(keyframe.world_from_camera.Inverse() * shown[l], bearing) /
                         kPatchCamera.AngleOfPixels(1.0));
      }
    }
    if (fraction != nullptr) *fraction = errors.size() / static_cast<double>(map.num_landmarks());
    return errors.empty() ? -1 : Median(errors);
  }
};

}  // namespace orb360
