#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "slam/depth/surface_point.h"

namespace orb360 {

/// Draws a cloud from above without perspective: x to the right, y up. Points higher than the
/// camera was nearby are left out, so that ceilings and trees do not hide the ground; the highest
/// of the remaining points is shown. Points are added in pieces of any size, in any order.
class CloudImage {
 public:
  /// `path` contains the positions of the camera, z up; the image shows them and their
  /// surroundings. `side` is the length of the image's longer side, pixels. Contract: there is at
  /// least one position.
  CloudImage(std::span<const Eigen::Vector3d> path, int side);

  void Add(std::span<const SurfacePoint> points);

  /// Returns CV_8UC3, BGR: the points with small gaps closed, the path over them, and a scale of
  /// length, in metres or, where the cloud is not metric, in its units.
  cv::Mat Draw(bool is_metric) const;

 private:
  struct Pixel {
    float height;
    cv::Vec3b bgr;
  };
  Eigen::Vector2d ToPixel(const Eigen::Vector2d& position) const;
  /// Height of the camera at its nearest position.
  double CameraHeight(const Eigen::Vector2f& position);

  std::vector<Eigen::Vector3d> path_;
  Eigen::AlignedBox2d box_;
  double pixels_per_unit_;
  cv::Size size_;
  std::vector<Pixel> pixels_;
  std::map<std::pair<int, int>, double> height_of_cell_;
};

}  // namespace orb360
