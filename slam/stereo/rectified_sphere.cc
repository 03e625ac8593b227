#include "slam/stereo/rectified_sphere.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

using std::numbers::pi;

// The image with one row more at each end, which continues it across the pole, and one column more.
cv::Mat ContinueSphere(const cv::Mat& gray) {
  cv::Mat padded(gray.rows + 2, gray.cols + 1, CV_8U);
  const int half = gray.cols / 2;
  for (int row = 0; row < padded.rows; ++row) {
    const bool is_beyond = row == 0 || row == padded.rows - 1;
    const uint8_t* from = gray.ptr(row == 0 ? 0 : std::min(row - 1, gray.rows - 1));
    uint8_t* to = padded.ptr(row);
    for (int column = 0; column <= gray.cols; ++column) {
      to[column] = from[(column + (is_beyond ? half : 0)) % gray.cols];
    }
  }
  return padded;
}

}  // namespace

Eigen::Matrix3d BaselineAxes(const Eigen::Vector3d& baseline) {
  Eigen::Matrix3d axes;
  axes.col(0) = baseline.normalized();
  int least = 0;  // the coordinate axis that is farthest from the baseline
  axes.col(0).cwiseAbs().minCoeff(&least);
  axes.col(1) = axes.col(0).cross(Eigen::Vector3d::Unit(least)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Eigen::Vector3d RectifiedBearing(const Eigen::Vector2d& pixel, const Eigen::Matrix3d& axes,
                                 int width) {
  const double polar = pixel.x() * pi / width;
  const double azimuth = pixel.y() * pi / width;
  return axes * Eigen::Vector3d(std::cos(polar), std::sin(polar) * std::cos(azimuth),
                                std::sin(polar) * std::sin(azimuth));
}

Eigen::Vector2d RectifiedPixel(const Eigen::Vector3d& direction, const Eigen::Matrix3d& axes,
                               int width) {
  const Eigen::Vector3d local = axes.transpose() * direction;
  const double polar = std::atan2(std::hypot(local.y(), local.z()), local.x());
  double azimuth = std::atan2(local.z(), local.y());
  if (azimuth < 0) azimuth += 2 * pi;
  const double row = azimuth * width / pi;
  return {polar * width / pi, row < 2 * width ? row : 0.0};
}

cv::Mat RectifySphere(const cv::Mat& gray, const Eigen::Matrix3d& axes, int width,
                      int num_threads) {
  const cv::Mat padded = ContinueSphere(gray);
  const EquirectangularCamera camera(gray.cols, gray.rows);
  const int height = 2 * width;
  cv::Mat rectified(height, width, CV_8U);
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int row = 0; row < height; ++row) {
    uint8_t* to = rectified.ptr(row);
    for (int column = 0; column < width; ++column) {
      const Eigen::Vector2d pixel =
          camera.Project(RectifiedBearing({column + 0.5, row + 0.5}, axes, width));
      const double u = pixel.x() - 0.5 + (pixel.x() < 0.5 ? gray.cols : 0);
      const double v = pixel.y() + 0.5;  // of the padded image
      const int left = static_cast<int>(u);
      const int top = std::min(static_cast<int>(v), gray.rows);
      const double a = u - left;
      const double b = v - top;
      const uint8_t* upper = padded.ptr(top) + left;
      const uint8_t* lower = padded.ptr(top + 1) + left;
      const double value =
          (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
      to[column] = static_cast<uint8_t>(std::lround(value));
    }
  }
  return rectified;
}

}  // namespace orb360
