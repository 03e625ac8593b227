#include "apps/town/sensor/dual_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "apps/town/image/noise.h"
#include <orb360/slam/geometry/camera.h>

namespace orb360::town {
namespace {

/// Bilinear sample; u wraps, and v is clamped to the outermost rows.
cv::Vec3f Sample(const cv::Mat3f& image, const Eigen::Vector2d& pixel) {
  const double x = std::floor(pixel.x() - 0.5);
  const double y = std::clamp(pixel.y() - 0.5, 0.0, image.rows - 1.0);
  const auto wx = static_cast<float>(pixel.x() - 0.5 - x);
  const int top = std::min(static_cast<int>(y), image.rows - 2);
  const auto wy = static_cast<float>(y - top);
  const int left = (static_cast<int>(x) + image.cols) % image.cols;
  const int right = (left + 1) % image.cols;
  return (1 - wy) * ((1 - wx) * image(top, left) + wx * image(top, right)) +
         wy * ((1 - wx) * image(top + 1, left) + wx * image(top + 1, right));
}

struct Lens {
  Eigen::Vector3d position;  // metres, camera frame; its direction is the optical axis
  double ahead;              // the optical axis along -x: 1, or -1
  double gain;
};

}  // namespace

Eigen::Vector3d SeenThroughLens(const Eigen::Vector3d& lens, const Eigen::Vector3d& bearing) {
  constexpr double kHeight = 1.9;  // metres, of the camera above the road
  constexpr double kWalls = 10;    // metres
  // The inverse of the distance is used, so that nothing is divided by zero.
  const double to_wall = std::hypot(bearing.x(), bearing.y()) / kWalls;
  const double to_road = std::max(0.0, -bearing.z()) / kHeight;
  return (bearing + std::max(to_wall, to_road) * lens).normalized();
}

cv::Mat3f StitchedFromTwoLenses(const DualLens& options, const cv::Mat3f& panorama) {
  const EquirectangularCamera camera(panorama.cols, panorama.rows);
  const Eigen::Vector3d forward(-0.5 * options.baseline, 0, 0);
  const double gain = std::exp2(0.5 * options.exposure_difference);
  const std::array<Lens, 2> lenses = {{{forward, 1, gain}, {-forward, -1, 1 / gain}}};
  const auto half_overlap = static_cast<float>(std::max(0.5 * options.overlap, 1e-6));
  cv::Mat3f result(panorama.size());
#pragma omp parallel for schedule(static)
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      const Eigen::Vector3d bearing = camera.Bearing({column + 0.5, row + 0.5});
      cv::Vec3f sum(0, 0, 0);
      for (const Lens& lens : lenses) {
        // Angle from the seam towards the lens's axis, radians.
        const double inside = std::asin(std::clamp(-lens.ahead * bearing.x(), -1.0, 1.0));
        const float weight = SmoothStep(-half_overlap, half_overlap, static_cast<float>(inside));
        if (weight == 0) continue;
        const double off_axis = 1 - inside / (std::numbers::pi / 2);  // 1 at the seam
        const double light = lens.gain * (1 - options.rim_loss * std::pow(off_axis, 4));
        sum += weight * static_cast<float>(light) *
               Sample(panorama, camera.Project(SeenThroughLens(lens.position, bearing)));
      }
      result(row, column) = sum;
    }
  }
  return result;
}

}  // namespace orb360::town
