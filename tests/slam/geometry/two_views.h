#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/bearing.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Bearings of points all around, seen by two cameras.
struct TwoViews {
  Rigid3 camera1_from_camera2;
  std::vector<Eigen::Vector3d> bearings1, bearings2;
  std::vector<bool> is_outlier;
  int num_outliers = 0;
};

struct TwoViewsOptions {
  int count = 300;
  double sigma = 0.0;          ///< noise of the bearings, radians
  double outlier_ratio = 0.0;  ///< matched to a bearing anywhere
  double nearest = 2.0, farthest = 20.0;
};

inline TwoViews MakeTwoViews(const Rigid3& camera1_from_camera2, const TwoViewsOptions& options,
                             RandomGeometry* random) {
  TwoViews views;
  views.camera1_from_camera2 = camera1_from_camera2;
  const Rigid3 camera2_from_camera1 = camera1_from_camera2.Inverse();
  for (int i = 0; i < options.count; ++i) {
    const Eigen::Vector3d point = random->Point(options.nearest, options.farthest);
    const bool is_outlier = random->Uniform(0.0, 1.0) < options.outlier_ratio;
    const Eigen::Vector3d bearing2 = (camera2_from_camera1 * point).normalized();
    views.bearings1.push_back(random->Noisy(point.normalized(), options.sigma));
    views.bearings2.push_back(is_outlier ? random->Bearing()
                                         : random->Noisy(bearing2, options.sigma));
    views.is_outlier.push_back(is_outlier);
    views.num_outliers += is_outlier;
  }
  return views;
}

inline double RotationError(const Rigid3& a, const Rigid3& b) {
  return LogSo3(a.rotation.conjugate() * b.rotation).norm();
}
inline double DirectionError(const Rigid3& a, const Rigid3& b) {
  return AngleBetween(a.translation, b.translation);
}

}  // namespace orb360
