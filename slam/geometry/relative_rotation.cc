#include "slam/geometry/relative_rotation.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t kSampleSize = 2;

// Bearings closer together than this (radians), or that close to opposite, determine no rotation.
constexpr double kMinSine = 1e-6;

/// Returns a right-handed frame with a on its first axis and b in the plane of the first two axes.
Matrix3d FrameOf(const Vector3d& a, const Vector3d& b) {
  const Vector3d normal = a.cross(b).normalized();
  Matrix3d frame;
  frame << a, normal.cross(a), normal;
  return frame;
}

}  // namespace

std::optional<RelativePose> EstimateRotation(std::span<const Vector3d> bearings1,
                                             std::span<const Vector3d> bearings2, Sigmas sigmas1,
                                             Sigmas sigmas2, const RansacOptions& options) {
  const size_t count = bearings1.size();
  ORB360_CHECK(bearings2.size() == count, count, bearings2.size());
  ORB360_CHECK(sigmas1.empty() || sigmas1.size() == count, count, sigmas1.size());
  ORB360_CHECK(sigmas2.empty() || sigmas2.size() == count, count, sigmas2.size());
  const auto variance = [&](size_t i) {
    const double sigma1 = internal::SigmaOf(sigmas1, i, options);
    const double sigma2 = internal::SigmaOf(sigmas2, i, options);
    return sigma1 * sigma1 + sigma2 * sigma2;
  };
  const auto error = [&](const Matrix3d& rotation, size_t i) {
    return (bearings1[i] - rotation * bearings2[i]).squaredNorm() / variance(i);
  };
  const auto solve = [&](const std::array<int, kSampleSize>& sample, const auto& consider) {
    const auto [i, j] = sample;
    const double sine1 = bearings1[i].cross(bearings1[j]).norm();
    const double sine2 = bearings2[i].cross(bearings2[j]).norm();
    if (!(sine1 > kMinSine && sine2 > kMinSine)) return;  // the turn about them is unknown
    consider(Matrix3d(FrameOf(bearings1[i], bearings1[j]) *
                      FrameOf(bearings2[i], bearings2[j]).transpose()));
  };
  // Returns the rotation that best turns bearings2 into bearings1 (Kabsch), weighted by the loss.
  const auto refine = [&](const Matrix3d& rotation, const TukeyLoss& loss) -> Matrix3d {
    Matrix3d correlation = Matrix3d::Zero();
    for (size_t i = 0; i < count; ++i) {
      const double weight = loss.Weight(error(rotation, i));
      if (weight == 0.0) continue;
      correlation += weight / variance(i) * bearings1[i] * bearings2[i].transpose();
    }
    const Eigen::JacobiSVD<Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
    return svd.matrixU() * Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  };
  const auto rotation = Ransac<Matrix3d, kSampleSize>(count, options, solve, error, refine);
  if (!rotation) return std::nullopt;

  const double limit = options.max_error * options.max_error;
  std::vector<bool> inliers(count);
  for (size_t i = 0; i < count; ++i) inliers[i] = error(*rotation, i) < limit;
  const auto num_inliers = static_cast<int>(std::count(inliers.begin(), inliers.end(), true));
  if (num_inliers < options.min_inliers) return std::nullopt;
  return RelativePose{{Eigen::Quaterniond(*rotation).normalized(), Vector3d::Zero()},
                      std::move(inliers),
                      num_inliers};
}

}  // namespace orb360
