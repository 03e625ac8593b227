#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A ball that is in the room.
struct Ball {
  Eigen::Vector3d centre;
  double radius;
};

/// Exact ranges of the inside of a box around the origin, in double precision.
struct RangeRoom {
  Eigen::Vector3d half_size{4, 3, 1.5};

  /// Along a ray from inside.
  double RangeOfWalls(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    double range = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      const double wall = direction[axis] > 0 ? half_size[axis] : -half_size[axis];
      if (std::abs(direction[axis]) > 1e-12) {
        range = std::min(range, (wall - from[axis]) / direction[axis]);
      }
    }
    return range;
  }

  double Range(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
               const std::optional<Ball>& ball) const {
    const double wall = RangeOfWalls(from, direction);
    if (!ball) return wall;
    const Eigen::Vector3d offset = from - ball->centre;
    const double half = offset.dot(direction);
    const double root = half * half - offset.squaredNorm() + ball->radius * ball->radius;
    const double range = root > 0 ? -half - std::sqrt(root) : -1;
    return range > 0 ? std::min(range, wall) : wall;
  }

  /// The colour tells the walls apart: 40 times the number of the axis, plus 100 where the wall is
  /// on its positive side.
  DenseDepth Render(const EquirectangularCamera& camera, const Rigid3& world_from_camera,
                    const std::optional<Ball>& ball = std::nullopt,
                    double confidence = 0.99) const {
    const cv::Size size(camera.width(), camera.height());
    DenseDepth depth{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1, cv::Scalar(confidence)),
                     cv::Mat(size, CV_8UC3)};
    for (int row = 0; row < size.height; ++row) {
      for (int column = 0; column < size.width; ++column) {
        const Eigen::Vector3d ray =
            world_from_camera.rotation * camera.Bearing({column + 0.5, row + 0.5});
        const double range = Range(world_from_camera.translation, ray, ball);
        depth.range.at<float>(row, column) = static_cast<float>(range);
        const Wall wall = WallAt(world_from_camera.translation + range * ray);
        const int grey = 40 * wall.axis + (wall.is_positive ? 100 : 0);
        depth.color.at<cv::Vec3b>(row, column) = cv::Vec3b::all(static_cast<uchar>(grey));
      }
    }
    return depth;
  }

  /// The wall's normal, inward, at `range` along a ray of a camera; camera frame.
  Eigen::Vector3d NormalAlong(const Rigid3& world_from_camera, const Eigen::Vector3d& bearing,
                              double range) const {
    const Wall wall = WallAt(world_from_camera * Eigen::Vector3d(range * bearing));
    const Eigen::Vector3d outward = Eigen::Vector3d::Unit(wall.axis);
    return world_from_camera.rotation.inverse() * (wall.is_positive ? -outward : outward);
  }

  /// Distance of a point inside from the walls.
  double DistanceFromWalls(const Eigen::Vector3d& point) const {
    return (half_size - point.cwiseAbs()).cwiseAbs().minCoeff();
  }

 private:
  struct Wall {
    int axis;
    bool is_positive;  // on the positive side of its axis
  };

  /// The one that is nearest to a point inside.
  Wall WallAt(const Eigen::Vector3d& point) const {
    int axis = 0;
    (half_size - point.cwiseAbs()).minCoeff(&axis);
    return {axis, point[axis] > 0};
  }
};

/// A camera at `position`, turned about a skewed axis, so that nothing is aligned with the walls.
inline Rigid3 TurnedCamera(const Eigen::Vector3d& position, double angle) {
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.3, -0.5, 0.8).normalized())),
      position};
}

}  // namespace orb360
