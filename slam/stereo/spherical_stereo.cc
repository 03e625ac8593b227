#include "slam/stereo/spherical_stereo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/stereo/rectified_sphere.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {

InverseRanges MatchSphere(const StereoView& reference, const StereoView& source,
                          const SphericalStereoOptions& options, int num_threads) {
  const Eigen::Vector3d baseline =
      source.world_from_camera.translation - reference.world_from_camera.translation;
  const double length = baseline.norm();
  ORB360_CHECK(length > 0 && reference.gray.size() == source.gray.size(), length);
  const Eigen::Matrix3d axes = BaselineAxes(baseline);
  const Eigen::Matrix3d reference_axes =
      reference.world_from_camera.rotation.conjugate().toRotationMatrix() * axes;
  const Eigen::Matrix3d source_axes =
      source.world_from_camera.rotation.conjugate().toRotationMatrix() * axes;
  const int width = reference.gray.cols / 2;
  const cv::Mat disparities = MatchSemiGlobally(
      RectifySphere(reference.gray, reference_axes, width, num_threads),
      RectifySphere(source.gray, source_axes, width, num_threads), options.matching, num_threads);
  const EquirectangularCamera camera(reference.gray.cols, reference.gray.rows);
  const double pixel_angle = std::numbers::pi / width;
  InverseRanges ranges{cv::Mat::zeros(reference.gray.size(), CV_32F),
                       cv::Mat::zeros(reference.gray.size(), CV_32F)};
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int row = 0; row < ranges.value.rows; ++row) {
    for (int column = 0; column < ranges.value.cols; ++column) {
      const Eigen::Vector2d pixel =
          RectifiedPixel(camera.Bearing({column + 0.5, row + 0.5}), reference_axes, width);
      const int x = std::min(static_cast<int>(pixel.x()), width - 1);
      const int y = std::min(static_cast<int>(pixel.y()), 2 * width - 1);
      const double angle = pixel_angle * disparities.at<float>(y, x);
      const double polar = pixel_angle * pixel.x();
      if (angle < 0 || polar < options.min_epipolar_angle ||
          polar + angle > std::numbers::pi - options.min_epipolar_angle) {
        continue;
      }
      // The sine rule in the triangle of both cameras and the point, and its derivative.
      const double across = length * std::sin(polar + angle);
      ranges.value.at<float>(row, column) = static_cast<float>(std::sin(angle) / across);
      ranges.sigma.at<float>(row, column) = static_cast<float>(
          options.disparity_sigma * pixel_angle * length * std::sin(polar) / (across * across));
    }
  }
  return ranges;
}

InverseRanges FuseInverseRanges(std::span<const InverseRanges> measured,
                                const SphericalStereoOptions& options) {
  const cv::Size size = measured.front().value.size();
  InverseRanges fused{cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      int most = 0;
      for (const InverseRanges& one : measured) {
        const float center = one.value.at<float>(row, column);
        const float spread = one.sigma.at<float>(row, column);
        if (!(spread > 0)) continue;
        int support = 0;
        double sum = 0;
        double information = 0;
        for (const InverseRanges& other : measured) {
          const float value = other.value.at<float>(row, column);
          const float sigma = other.sigma.at<float>(row, column);
          if (!(sigma > 0)) continue;
          if (std::abs(value - center) > options.max_sigmas * std::hypot(spread, sigma)) continue;
          ++support;
          sum += value / (sigma * sigma);
          information += 1.0 / (sigma * sigma);
        }
        if (support <= most) continue;
        most = support;
        fused.value.at<float>(row, column) = static_cast<float>(sum / information);
        fused.sigma.at<float>(row, column) = static_cast<float>(1 / std::sqrt(information));
      }
      float& value = fused.value.at<float>(row, column);
      float& sigma = fused.sigma.at<float>(row, column);
      if (most < options.min_support || !(sigma < options.max_sigma * value)) value = sigma = 0;
    }
  }
  return fused;
}

}  // namespace orb360
