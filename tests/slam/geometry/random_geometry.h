#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Seeded source of synthetic truth for the tests of the geometry. Numbers are drawn in separate
/// statements: the order in which a compiler evaluates arguments is its own.
class RandomGeometry {
 public:
  explicit RandomGeometry(unsigned seed) : generator_(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  double Normal(double sigma) { return std::normal_distribution<double>(0.0, sigma)(generator_); }

  /// Uniform over the sphere.
  Eigen::Vector3d Bearing() {
    const double z = Uniform(-1.0, 1.0);
    const double longitude = Uniform(-std::numbers::pi, std::numbers::pi);
    const double h = std::sqrt(1.0 - z * z);
    return {h * std::cos(longitude), h * std::sin(longitude), z};
  }
  /// In every direction, with a range between the two.
  Eigen::Vector3d Point(double nearest, double farthest) {
    const double range = Uniform(nearest, farthest);
    return range * Bearing();
  }
  /// About a random axis, by an angle up to the one given.
  Eigen::Quaterniond Rotation(double angle = std::numbers::pi) {
    const double signed_angle = Uniform(-angle, angle);
    return Eigen::Quaterniond(Eigen::AngleAxisd(signed_angle, Bearing()));
  }
  Rigid3 Transform() { return {Rotation(), Point(0.5, 5.0)}; }
  Similarity3 Similarity() { return {Uniform(0.2, 5.0), Rotation(), Point(0.5, 5.0)}; }

  /// The bearing turned by Gaussian noise of `sigma` radians in each of the two tangent directions.
  Eigen::Vector3d Noisy(const Eigen::Vector3d& bearing, double sigma) {
    Eigen::Vector3d noise;
    for (double& element : noise) element = Normal(sigma);
    return (bearing + noise - bearing.dot(noise) * bearing).normalized();
  }

 private:
  std::mt19937 generator_;
};

}  // namespace orb360
