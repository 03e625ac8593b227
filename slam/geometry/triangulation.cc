#include "slam/geometry/triangulation.h"

#include <cmath>

#include <Eigen/Cholesky>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Rays closer to parallel than this (radians) do not intersect; their range would be rounding
// error.
constexpr double kMinParallax = 1e-7;

// The weights converge geometrically. After two passes the point moves by far less than its noise.
constexpr int kReweightings = 2;

}  // namespace

std::optional<Eigen::Vector3d> Triangulate(std::span<const Rigid3> camera_from_world,
                                           std::span<const Eigen::Vector3d> bearings) {
  ORB360_CHECK(camera_from_world.size() == bearings.size(), camera_from_world.size(),
               bearings.size());
  if (bearings.size() < 2) return std::nullopt;
  // Positions are relative to the first centre, so that a map far from its origin loses no digits.
  const Eigen::Vector3d origin = camera_from_world[0].Inverse().translation;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int pass = 0; pass <= kReweightings; ++pass) {
    // The two tangent rows of a view are B^T R X = -B^T t; B B^T = I - bearing bearing^T.
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
    double weights = 0.0;
    for (size_t i = 0; i < bearings.size(); ++i) {
      const Eigen::Quaterniond world_from_camera = camera_from_world[i].rotation.conjugate();
      const Eigen::Vector3d ray = world_from_camera * bearings[i];
      const Eigen::Vector3d center = world_from_camera * -camera_from_world[i].translation - origin;
      const double weight = pass == 0 ? 1.0 : 1.0 / (point - center).squaredNorm();
      const Eigen::Matrix3d rows = weight * (Eigen::Matrix3d::Identity() - ray * ray.transpose());
      normal_matrix += rows;
      right_side += rows * center;
      weights += weight;
    }
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(normal_matrix);
    // The smallest pivot is a weighted mean of sin^2 of the angles between the rays and their
    // common direction.
    if (!(ldlt.vectorD().minCoeff() > kMinParallax * kMinParallax * weights)) return std::nullopt;
    point = ldlt.solve(right_side);
  }
  point += origin;
  for (size_t i = 0; i < bearings.size(); ++i) {
    if (!HasPositiveRange(camera_from_world[i], point, bearings[i])) return std::nullopt;
  }
  return point;
}

std::optional<Eigen::Vector3d> TriangulateTwoViews(const Rigid3& camera1_from_camera2,
                                                   const Eigen::Vector3d& bearing1,
                                                   const Eigen::Vector3d& bearing2, double sigma1,
                                                   double sigma2) {
  const double baseline = camera1_from_camera2.translation.norm();
  if (!(baseline > 0.0)) return std::nullopt;
  const Eigen::Vector3d axis = camera1_from_camera2.translation / baseline;
  const Eigen::Vector3d ray2 = camera1_from_camera2.rotation * bearing2;
  // The rays as seen along the baseline, where each plane through it is a line through the origin.
  const Eigen::Matrix<double, 3, 2> across = TangentBasis(axis);
  const Eigen::Vector2d side1 = across.transpose() * bearing1;
  const Eigen::Vector2d side2 = across.transpose() * ray2;
  const Eigen::Vector2d a = sigma2 * side1;
  const Eigen::Vector2d b = sigma1 * side2;
  // The line closest to a and b is the major axis of a a^T + b b^T; (cos, sin) of twice its angle:
  const Eigen::Vector2d twice(a.x() * a.x() - a.y() * a.y() + b.x() * b.x() - b.y() * b.y(),
                              2.0 * (a.x() * a.y() + b.x() * b.y()));
  const double length = twice.norm();
  if (!(length > 0.0)) return std::nullopt;  // both on the baseline, or no plane is the closest
  // Half-angle formulas; the one without cancellation is used.
  const Eigen::Vector2d line = (twice.x() > 0.0 ? Eigen::Vector2d(length + twice.x(), twice.y())
                                                : Eigen::Vector2d(twice.y(), length - twice.x()))
                                   .normalized();
  // Both rays in the coordinates of that plane: along the baseline and across it.
  const double along1 = axis.dot(bearing1), across1 = line.dot(side1);
  const double along2 = axis.dot(ray2), across2 = line.dot(side2);
  const double sine = along1 * across2 - along2 * across1;
  if (!(std::abs(sine) > kMinParallax)) return std::nullopt;
  const double range1 = baseline * across2 / sine;
  const double range2 = baseline * across1 / sine;
  if (!(range1 > 0.0 && range2 > 0.0)) return std::nullopt;
  return range1 * (along1 * axis + across1 * (across * line));
}

}  // namespace orb360
