#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "slam/features/feature_index.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/features/features.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// A street round a block, driven with cameras that see what is near, and the map that such a drive
/// makes, drift included: features without images, landmarks without matching.
class RingStreet {
 public:
  static constexpr double kRadius = 30.0;
  static constexpr double kSight = 14.0;
  static constexpr double kSigma = 0.001;  // rad, of a bearing on level 0

  /// `num_alike`: so many sections of the ring show exactly the same, one after the other.
  explicit RingStreet(int num_points, int num_alike = 1) {
    const double section = 2.0 * std::numbers::pi / num_alike;
    for (int i = 0; i < num_points / num_alike; ++i) {
      Descriptor descriptor;
      for (uint64_t& word : descriptor) {
        word = static_cast<uint64_t>(random_.Uniform(0.0, 1.0) * 4294967296.0) << 32 |
               static_cast<uint64_t>(random_.Uniform(0.0, 1.0) * 4294967296.0);
      }
      const double angle = random_.Uniform(0.0, section);
      const double side = random_.Uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
      const double radius = kRadius + side * random_.Uniform(3.0, 8.0);
      const double height = random_.Uniform(-2.0, 5.0);
      for (int s = 0; s < num_alike; ++s) {
        const double at = angle + s * section;
        points_.push_back({{radius * std::cos(at), radius * std::sin(at), height}, descriptor});
      }
    }
  }

  /// After a way of `arc` radians round the block, `offset` to the side, turned by `yaw`.
  static Rigid3 PoseAt(double arc, double offset = 0.0, double yaw = 0.0) {
    const double r = kRadius + offset;
    return {ExpSo3({0, 0, arc + yaw}), {r * std::cos(arc), r * std::sin(arc), 0.0}};
  }

  struct View {
    std::shared_ptr<const Features> features;
    std::vector<int> points;  // by feature
  };
  /// Each bit of a descriptor is another one with a probability of `flips`.
  View See(const Rigid3& world_from_camera, double flips = 0.1) {
    auto features = std::make_shared<Features>();
    View view;
    const Rigid3 camera_from_world = world_from_camera.Inverse();
    for (size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d p = camera_from_world * points_[i].position;
      if (p.norm() > kSight) continue;
      const int level = std::clamp(PredictLevel(kSight, p.norm()), 0, 7);
      const double sigma = kSigma * std::exp2(level / 4.0);
      features->bearings.push_back(random_.Noisy(p.normalized(), sigma));
      Descriptor bits = points_[i].descriptor;
      for (int b = 0; b < 256; ++b) {
        if (random_.Uniform(0.0, 1.0) < flips) bits[b / 64] ^= uint64_t{1} << (b % 64);
      }
      features->descriptors.push_back(bits);
      features->colors.push_back({1, 2, 3});
      features->keypoints.push_back({Eigen::Vector2f::Zero(), 0.0f, static_cast<float>(sigma),
                                     static_cast<uint8_t>(level), 50});
      view.points.push_back(static_cast<int>(i));
    }
    IndexFeatures(features.get());
    view.features = std::move(features);
    return view;
  }

  /// The drive's map so far. A point is a landmark for as long as it stays in sight.
  struct Drive {
    Map map;
    std::vector<Rigid3> truth;  // by keyframe
    Similarity3 drift;          // the map's world around the newest keyframe, from the true one
    std::vector<LandmarkId> landmark_of_point;
    View last;
  };
  /// Adds a keyframe; the map drifts by `step` meanwhile.
  KeyframeId DriveOn(const Rigid3& pose, const Similarity3& step, Drive* drive) {
    const View view = See(pose);
    Map& map = drive->map;
    // Around the camera, so that nothing jumps.
    const Similarity3 there{1.0, Eigen::Quaterniond::Identity(), pose.translation};
    drive->drift = drive->drift * there * step * there.Inverse();
    const KeyframeId id =
        map.AddKeyframe(static_cast<int>(drive->truth.size()), 0.1 * drive->truth.size(),
                        TransformPose(drive->drift, pose), view.features);
    drive->truth.push_back(pose);
    drive->landmark_of_point.resize(points_.size(), kNoId);
    std::vector<LandmarkId> now(points_.size(), kNoId);
    for (size_t f = 0; f < view.points.size(); ++f) {
      const int point = view.points[f];
      const auto before = std::find(drive->last.points.begin(), drive->last.points.end(), point);
      if (before == drive->last.points.end()) continue;
      LandmarkId landmark = drive->landmark_of_point[point];
      if (landmark == kNoId) {
        landmark = map.AddLandmark(drive->drift * points_[point].position, {1, 2, 3});
        map.AddObservation(landmark, id - 1, static_cast<int>(before - drive->last.points.begin()));
      }
      map.AddObservation(landmark, id, static_cast<int>(f));
      map.UpdateAppearance(landmark);
      now[point] = landmark;
    }
    drive->landmark_of_point = std::move(now);
    drive->last = view;
    return id;
  }

 private:
  struct Point {
    Eigen::Vector3d position;
    Descriptor descriptor;
  };
  RandomGeometry random_{11};
  std::vector<Point> points_;
};

}  // namespace orb360
