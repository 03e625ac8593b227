#include "tests/slam/io/lenses/rendered_fisheye.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orb360 {
namespace {

constexpr int kCells = 48;  // of the texture along each side of the cube from -1 to 1

}  // namespace

cv::Mat RenderFisheye(const FisheyeLens& lens,
                      const std::function<cv::Vec3b(const Eigen::Vector3d&)>& color_of) {
  constexpr int kSteps = 20000;
  std::vector<double> radii(kSteps + 1);
  const double step = 0.5 * lens.field_of_view / kSteps;
  const auto& k = lens.polynomial;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = i * step;
    radii[i] = lens.focal * (t + k[0] * std::pow(t, 3) + k[1] * std::pow(t, 5) +
                             k[2] * std::pow(t, 7) + k[3] * std::pow(t, 9));
  }
  cv::Mat image = cv::Mat::zeros(lens.size, CV_8UC3);
  for (int row = 0; row < lens.size.height; ++row) {
    for (int col = 0; col < lens.size.width; ++col) {
      const double x = col + 0.5 - lens.center.x();
      const double y = row + 0.5 - lens.center.y();
      const double radius = std::hypot(x, y);
      if (radius >= radii.back()) continue;
      const auto above = std::upper_bound(radii.begin(), radii.end(), radius);
      const double fraction = (radius - *(above - 1)) / (*above - *(above - 1));
      const double angle = step * (static_cast<double>(above - 1 - radii.begin()) + fraction);
      const double around = std::atan2(y, x);
      const Eigen::Vector3d optical =
          lens.camera_from_lens * Eigen::Vector3d(std::sin(angle) * std::cos(around),
                                                  std::sin(angle) * std::sin(around),
                                                  std::cos(angle));
      image.at<cv::Vec3b>(row, col) =
          color_of(Eigen::Vector3d(-optical.z(), optical.x(), -optical.y()));
    }
  }
  return image;
}

TexturedSphere::TexturedSphere(unsigned seed)
    : noise_((kCells + 1) * (kCells + 1), kCells + 1, CV_8UC3) {
  cv::RNG random(seed);
  random.fill(noise_, cv::RNG::UNIFORM, 30, 226);
}

cv::Vec3b TexturedSphere::operator()(const Eigen::Vector3d& bearing) const {
  const Eigen::Vector3d at = (bearing.array() + 1.0) * (0.5 * kCells);
  Eigen::Vector3i cell;
  for (int i = 0; i < 3; ++i) cell[i] = std::clamp(static_cast<int>(at[i]), 0, kCells - 1);
  const Eigen::Vector3d f = at - cell.cast<double>();
  cv::Vec3d color(0, 0, 0);
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1;
    const int dy = corner >> 1 & 1;
    const int dz = corner >> 2;
    const double weight =
        (dx ? f.x() : 1 - f.x()) * (dy ? f.y() : 1 - f.y()) * (dz ? f.z() : 1 - f.z());
    color += weight * cv::Vec3d(noise_.at<cv::Vec3b>((cell.z() + dz) * (kCells + 1) + cell.y() + dy,
                                                     cell.x() + dx));
  }
  return color;
}

}  // namespace orb360
