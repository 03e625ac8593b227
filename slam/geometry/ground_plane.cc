#include "slam/geometry/ground_plane.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>

namespace orb360 {
namespace {

constexpr int kMaxSamples = 300;     // of three points
constexpr int kMinSamples = 30;      // three points on the ground may still be too close together
constexpr double kMaxMissed = 1e-4;  // probability that no sample lies on the ground
constexpr int kRefinements = 5;      // of the plane by the points on it
// Reach of the biweight in median deviations. With 4.685 standard deviations it is 95 % as
// efficient as least squares on normally distributed points.
constexpr double kBiweightReach = 4.685 * 1.4826;
constexpr double kMinTolerance = 0.1;  // as a fraction of the first one

struct Plane {
  Eigen::Vector3d normal;  // unit, towards the origin
  double height;
};

// Tukey's biweight of a point: 1 on the plane, 0 beyond the tolerance.
double Weight(const Plane& plane, const Eigen::Vector3d& point, double tolerance) {
  const double error = (plane.normal.dot(point) + plane.height) / (tolerance * plane.height);
  const double rest = std::max(0.0, 1.0 - error * error);
  return rest * rest;
}

// Returns a tolerance that fits the noise of the points on a plane.
double NarrowTolerance(const Plane& plane, std::span<const Eigen::Vector3d> points,
                       double tolerance) {
  std::vector<double> errors;
  for (const Eigen::Vector3d& p : points) {
    const double error = std::abs(plane.normal.dot(p) / plane.height + 1);
    if (error < tolerance) errors.push_back(error);
  }
  if (errors.empty()) return tolerance;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return tolerance * std::clamp(kBiweightReach * *middle / tolerance, kMinTolerance, 1.0);
}

// Returns the sum of all weights, or a number below `least` if the sum cannot reach `least`.
double Support(const Plane& plane, std::span<const Eigen::Vector3d> points, double tolerance,
               double least) {
  constexpr size_t kPart = 32;  // points between two looks at what is left
  double sum = 0;
  for (size_t first = 0; first < points.size(); first += kPart) {
    const std::span rest = points.subspan(first);
    if (sum + static_cast<double>(rest.size()) < least) break;
    for (const Eigen::Vector3d& p : rest.first(std::min(kPart, rest.size()))) {
      sum += Weight(plane, p, tolerance);
    }
  }
  return sum;
}

std::optional<Plane> Through(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                             const Eigen::Vector3d& c, const Eigen::Vector3d& up,
                             double min_cosine) {
  Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  if (normal.dot(up) < 0) normal = -normal;
  const double height = -normal.dot(a);
  // The comparison is also false for NaN, which three collinear points give.
  if (!(normal.dot(up) > min_cosine && height > 0)) return std::nullopt;
  return Plane{normal, height};
}

Plane Refined(const Plane& plane, std::span<const Eigen::Vector3d> points, double tolerance) {
  double sum = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const double weight = Weight(plane, p, tolerance);
    sum += weight;
    mean += weight * p;
  }
  mean /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    covariance += Weight(plane, p, tolerance) * (p - mean) * (p - mean).transpose();
  }
  Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  if (normal.dot(plane.normal) < 0) normal = -normal;
  return {normal, -normal.dot(mean)};
}

}  // namespace

std::optional<GroundPlane> FitGroundPlane(std::span<const Eigen::Vector3d> points,
                                          const Eigen::Vector3d& up,
                                          const GroundPlaneOptions& options) {
  std::vector<int> indices;
  std::vector<Eigen::Vector3d> below;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!(up.dot(points[i]) < -std::sin(options.min_below) * points[i].norm())) continue;
    indices.push_back(static_cast<int>(i));
    below.push_back(points[i]);
  }
  if (static_cast<int>(below.size()) < std::max(options.min_points, 3)) return std::nullopt;

  std::mt19937 random(1);
  const double min_cosine = std::cos(options.max_tilt);
  std::optional<Plane> best;
  double best_support = 0;
  int num_samples = kMaxSamples;
  for (int i = 0; i < num_samples; ++i) {
    const Eigen::Vector3d& a = below[random() % below.size()];
    const Eigen::Vector3d& b = below[random() % below.size()];
    const Eigen::Vector3d& c = below[random() % below.size()];
    const std::optional<Plane> plane = Through(a, b, c, up, min_cosine);
    if (!plane) continue;
    const double support = Support(*plane, below, options.tolerance, best_support);
    if (support > best_support) {
      best_support = support;
      best = plane;
      // The sum of weights is smaller than the number of points on the plane, so this draws too
      // many samples rather than too few.
      const double fraction = support / static_cast<double>(below.size());
      const double needed = std::log(kMaxMissed) / std::log1p(-std::pow(fraction, 3));
      if (needed < kMaxSamples) {
        num_samples = std::max(kMinSamples, static_cast<int>(std::ceil(needed)));
      }
    }
  }
  if (!best) return std::nullopt;
  const auto refine = [&](double tolerance) {
    for (int i = 0; i < kRefinements; ++i) {
      best = Refined(*best, below, tolerance);
      if (!(best->height > 0 && best->normal.dot(up) > min_cosine)) return false;
    }
    return true;
  };
  if (!refine(options.tolerance)) return std::nullopt;
  const auto on_it = std::ranges::count_if(
      below, [&](const Eigen::Vector3d& p) { return Weight(*best, p, options.tolerance) > 0; });
  if (on_it < options.min_points ||
      static_cast<double>(on_it) < options.min_fraction * static_cast<double>(below.size())) {
    return std::nullopt;
  }
  const double narrow = NarrowTolerance(*best, below, options.tolerance);
  if (!refine(narrow)) return std::nullopt;
  GroundPlane ground{best->normal, best->height, {}, {}};
  for (size_t i = 0; i < below.size(); ++i) {
    const double weight = Weight(*best, below[i], narrow);
    if (!(weight > 0)) continue;
    ground.points.push_back(indices[i]);
    ground.weights.push_back(weight);
  }
  return ground;
}

}  // namespace orb360
