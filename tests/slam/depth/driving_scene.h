#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A box that stands on the ground beside the path and moves along: by `speed` for each unit that
/// the camera moves along the x axis. It is at `corner` when the camera is at the origin.
struct MovingBox {
  Eigen::Vector3d corner;
  Eigen::Vector3d size;
  double speed;
};

/// Flat ground below a camera that moves along the x axis, in double precision. At the origin its
/// height is 1.4.
struct DrivingScene {
  static constexpr double kHeight = 1.4;
  static constexpr double kSky = 60;

  std::optional<MovingBox> box = {};
  /// Beyond this y the ground is lower, by `fall`.
  double edge = 1e9;
  double fall = 0;
  /// A wall beyond the lower ground, which rises above all cameras.
  double wall = 1e9;
  /// Height of the camera elsewhere: it has come up to the origin on a ramp that it does not see.
  double height_elsewhere = kHeight;

  /// What views elsewhere see of the ground is higher by this, as on a bumpy road.
  double bump = 0;

  double HeightAt(double x) const { return x == 0 ? kHeight : height_elsewhere; }
  double HeightOverGroundAt(double x) const { return HeightAt(x) - (x == 0 ? 0 : bump); }

  Rigid3 CameraAt(double x) const {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * x, Eigen::Vector3d::UnitZ())),
            {x, 0, HeightAt(x) - kHeight}};
  }

  /// The true range along a ray; of the sky kSky.
  double Range(double camera_x, const Eigen::Vector3d& ray) const {
    const double on_box = RangeOfBox(camera_x, ray);
    return on_box > 0 ? on_box : RangeAtRest(HeightOverGroundAt(camera_x), ray);
  }

  /// 0 where a ray does not meet the box.
  double RangeOfBox(double camera_x, const Eigen::Vector3d& ray) const {
    if (!box) return 0;
    const Eigen::Vector3d low = box->corner + Eigen::Vector3d((box->speed - 1) * camera_x, 0, 0);
    const Eigen::Array3d to_low = low.array() / ray.array();
    const Eigen::Array3d to_high = (low + box->size).array() / ray.array();
    const double enter = to_low.min(to_high).maxCoeff();
    const double leave = to_low.max(to_high).minCoeff();
    return enter > 0 && enter < leave ? enter : 0;
  }

  /// What stereo sees: the range of the box is larger, because it moves.
  DenseDepth Render(const EquirectangularCamera& camera, double camera_x) const {
    const cv::Size size(camera.width(), camera.height());
    DenseDepth depth{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F, cv::Scalar(0.97)),
                     cv::Mat(size, CV_8UC3, cv::Scalar::all(0)),
                     cv::Mat(size, CV_8U, cv::Scalar(static_cast<double>(RangeSource::kMeasured)))};
    for (int row = 0; row < size.height; ++row) {
      for (int column = 0; column < size.width; ++column) {
        const Eigen::Vector3d ray =
            CameraAt(camera_x).rotation * camera.Bearing({column + 0.5, row + 0.5});
        const double on_box = RangeOfBox(camera_x, ray);
        const double range =
            on_box > 0 ? on_box / (1 - box->speed) : RangeAtRest(HeightOverGroundAt(camera_x), ray);
        depth.range.at<float>(row, column) = static_cast<float>(range);
        if (range == kSky) {
          depth.confidence.at<float>(row, column) = 0.1F;
          depth.source.at<std::uint8_t>(row, column) =
              static_cast<std::uint8_t>(RangeSource::kCompleted);
        }
      }
    }
    return depth;
  }

 private:
  double RangeAtRest(double height, const Eigen::Vector3d& ray) const {
    const double to_wall = ray.y() > 0 ? std::min(wall / ray.y(), kSky) : kSky;
    if (!(ray.z() < 0)) return to_wall;
    const double near = height / -ray.z();
    if (near * ray.y() <= edge) return std::min(near, kSky);
    return std::min((height + fall) / -ray.z(), to_wall);
  }
};

}  // namespace orb360
