#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/features/sphere_pyramid.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Gray value of a place on the ground.
using Ground = std::function<double(const Eigen::Vector2d&)>;

inline constexpr int kGroundWidth = 1024;

/// Value noise: random numbers on a lattice, blended smoothly.
class Asphalt {
 public:
  explicit Asphalt(unsigned seed) {
    std::mt19937 random(seed);
    for (float& value : lattice_) value = static_cast<float>(random() % 1000) / 1000.0F;
  }
  double operator()(const Eigen::Vector2d& place) const {
    return 110 + 40 * Octave(place / 0.15) + 30 * Octave(place / 0.05 + Eigen::Vector2d(31, 17));
  }

 private:
  static constexpr int kSide = 256;
  double At(int x, int y) const { return lattice_[(y & (kSide - 1)) * kSide + (x & (kSide - 1))]; }
  double Octave(const Eigen::Vector2d& p) const {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double a = smooth(p.x() - x);
    const double b = smooth(p.y() - y);
    return (1 - b) * ((1 - a) * At(x, y) + a * At(x + 1, y)) +
           b * ((1 - a) * At(x, y + 1) + a * At(x + 1, y + 1)) - 0.5;
  }
  std::vector<float> lattice_ = std::vector<float>(kSide * kSide);
};

/// What a camera sees, with gray noise. `shade`: gray value of what a ray below the horizon meets,
/// from a lens and a direction in the world; above the horizon there is a plain sky. The camera has
/// one lens that looks ahead (x) and one that looks back, `lens_distance` apart.
using Shade = std::function<double(const Eigen::Vector3d& lens, const Eigen::Vector3d& ray)>;

inline SpherePyramid LookDownAt(const Shade& shade, const Rigid3& world_from_camera,
                                double noise = 1.0, double lens_distance = 0.0) {
  const EquirectangularCamera camera(kGroundWidth, kGroundWidth / 2);
  cv::Mat gray(kGroundWidth / 2, kGroundWidth, CV_8U);
  std::mt19937 random(static_cast<unsigned>(1e6 * world_from_camera.translation.x()) + 7);
  std::normal_distribution<double> normal(0.0, noise);
  for (int v = 0; v < gray.rows; ++v) {
    for (int u = 0; u < gray.cols; ++u) {
      const Eigen::Vector3d bearing = camera.Bearing({u + 0.5, v + 0.5});
      const Eigen::Vector3d ray = world_from_camera.rotation * bearing;
      double value = 200;
      if (ray.z() < -0.01) {
        const double ahead = (bearing.x() > 0 ? 0.5 : -0.5) * lens_distance;
        value = shade(world_from_camera * Eigen::Vector3d(ahead, 0, 0), ray);
      }
      gray.at<uint8_t>(v, u) = cv::saturate_cast<uint8_t>(value + normal(random));
    }
  }
  SpherePyramid pyramid;
  BuildSpherePyramid(gray, 8, &pyramid);
  return pyramid;
}

/// The same over the plane z = 0.
inline SpherePyramid LookAtGround(const Rigid3& world_from_camera, const Ground& ground,
                                  double noise = 1.0, double lens_distance = 0.0) {
  const auto shade = [&ground](const Eigen::Vector3d& lens, const Eigen::Vector3d& ray) {
    return ground((lens - lens.z() / ray.z() * ray).head<2>());
  };
  return LookDownAt(shade, world_from_camera, noise, lens_distance);
}

}  // namespace orb360
