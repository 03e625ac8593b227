#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// The inside of a textured box, rendered exactly: the camera's truth is known to rounding.
class BoxRoom {
 public:
  /// `half_size`: half its extent along x, y and z. Different seeds give other textures.
  BoxRoom(const Eigen::Vector3d& half_size, uint64_t seed) : half_size_(half_size) {
    cv::RNG random(seed);
    for (std::vector<cv::Mat>& wall : walls_) wall = MakePyramid(&random);
  }

  /// CV_8UC3 of the whole sphere. The camera must be inside.
  cv::Mat Render(const EquirectangularCamera& camera, const Rigid3& world_from_camera) const {
    cv::Mat image(camera.height(), camera.width(), CV_8UC3);
    const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
    const Eigen::Vector3d& center = world_from_camera.translation;
    const double pixel = camera.AngleOfPixels(1.0);
#pragma omp parallel for
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector3d ray = rotation * camera.Bearing({u + 0.5, v + 0.5});
        const auto [range, axis] = Hit(center, ray);
        const Eigen::Vector3d hit = center + range * ray;
        const double footprint = range * pixel / std::abs(ray[axis]);
        const float value = Sample(walls_[2 * axis + (ray[axis] > 0)], hit[(axis + 1) % 3],
                                   hit[(axis + 2) % 3], footprint);
        image.at<cv::Vec3b>(v, u) = cv::Vec3b::all(cv::saturate_cast<uint8_t>(value));
      }
    }
    return image;
  }

  /// Metres from a point inside along a unit vector.
  double Range(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    return Hit(from, ray).range;
  }

 private:
  struct WallHit {
    double range;
    int axis;  // across the wall
  };
  WallHit Hit(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    WallHit nearest{1e9, 0};
    for (int i = 0; i < 3; ++i) {
      const double wall = ray[i] > 0 ? half_size_[i] : -half_size_[i];
      const double distance = (wall - from[i]) / ray[i];
      if (std::abs(ray[i]) > 1e-12 && distance < nearest.range) nearest = {distance, i};
    }
    return nearest;
  }

  static constexpr double kTexelsPerMetre = 64.0;
  static constexpr int kTextureSize = 1024;  // repeats after 16 m

  // Rectangles of many sizes on cloudy ground, and the halved copies for distant walls.
  static std::vector<cv::Mat> MakePyramid(cv::RNG* random) {
    cv::Mat texture(kTextureSize, kTextureSize, CV_32F, cv::Scalar(128.0));
    for (int i = 0; i < 2500; ++i) {
      const int width = static_cast<int>(4.0 * std::exp(random->uniform(0.0, 3.0)));
      const int height = static_cast<int>(4.0 * std::exp(random->uniform(0.0, 3.0)));
      const cv::Point corner(random->uniform(0, kTextureSize), random->uniform(0, kTextureSize));
      cv::rectangle(texture, cv::Rect(corner, cv::Size(width, height)),
                    cv::Scalar(random->uniform(20.0, 235.0)), cv::FILLED);
    }
    cv::GaussianBlur(texture, texture, {0, 0}, 1.0);
    std::vector<cv::Mat> levels = {texture};
    while (levels.back().cols > 8) {
      cv::Mat half;
      cv::resize(levels.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
      levels.push_back(half);
    }
    return levels;
  }

  static float Bilinear(const cv::Mat& level, double x, double y) {
    const int mask = level.cols - 1;
    const double fx = std::floor(x - 0.5);
    const double fy = std::floor(y - 0.5);
    const int x0 = static_cast<int>(fx) & mask;
    const int y0 = static_cast<int>(fy) & mask;
    const int x1 = (x0 + 1) & mask;
    const int y1 = (y0 + 1) & mask;
    const auto a = static_cast<float>(x - 0.5 - fx);
    const auto b = static_cast<float>(y - 0.5 - fy);
    return (1 - b) * ((1 - a) * level.at<float>(y0, x0) + a * level.at<float>(y0, x1)) +
           b * ((1 - a) * level.at<float>(y1, x0) + a * level.at<float>(y1, x1));
  }

  // Trilinear: the level whose texels are as large as the pixel's footprint.
  static float Sample(const std::vector<cv::Mat>& levels, double x, double y, double footprint) {
    const double lod = std::clamp(std::log2(std::max(footprint * kTexelsPerMetre, 1.0)), 0.0,
                                  static_cast<double>(levels.size()) - 1.001);
    const int level = static_cast<int>(lod);
    const double scale = kTexelsPerMetre / std::exp2(level);
    const float fine = Bilinear(levels[level], x * scale, y * scale);
    const float coarse = Bilinear(levels[level + 1], 0.5 * x * scale, 0.5 * y * scale);
    const auto t = static_cast<float>(lod - level);
    return (1 - t) * fine + t * coarse;
  }

  Eigen::Vector3d half_size_;
  std::array<std::vector<cv::Mat>, 6> walls_;  // -x, +x, -y, +y, -z, +z
};

}  // namespace orb360
