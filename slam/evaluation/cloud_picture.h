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

/// A cloud from above, without perspective: x to the right, y up. What is higher than the camera
/// was nearby is left out, so that ceilings and trees do not hide the ground; of the rest the
/// highest is seen. Points are shown in pieces of any size, in any order.
class CloudPicture {
 public:
  /// `path`: where the camera was, z up; the picture shows that and its surroundings. `side`: of
  /// the picture's longer side, pixels. Contract: there is a position.
  CloudPicture(std::span<const Eigen::Vector3d> path, int side);

  void Add(std::span<const SurfacePoint> points);

  /// CV_8UC3, BGR: the points, small gaps between them closed, the path over them, and a scale of
  /// length.
  cv::Mat Draw() const;

 private:
  struct Pixel {
    float height;
    cv::Vec3b bgr;
  };
  Eigen::Vector2d ToPixel(const Eigen::Vector2d& position) const;
  /// Of the camera where it was nearest.
  double CameraHeight(const Eigen::Vector2f& position);

  std::vector<Eigen::Vector3d> path_;
  Eigen::AlignedBox2d box_;
  double pixels_per_unit_;
  cv::Size size_;
  std::vector<Pixel> pixels_;
  std::map<std::pair<int, int>, double> height_of_cell_;
};

}  // namespace orb360
