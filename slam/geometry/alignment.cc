#include "slam/geometry/alignment.h"

#include <numeric>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Points are taken for one place when they differ by less than this fraction of their distance from
// the origin, which is the rounding error of their mean.
constexpr double kSamePlace = 1e-12;

// Points are taken for collinear when the second singular value of the covariance is below this
// fraction of the first, which is a millionth of the line's length on either side.
constexpr double kSameLine = 1e-12;

/// The rotation about the centroids, and the sums from which the scale follows.
struct Centered {
  Vector3d source_mean, target_mean;
  double source_variance = 0.0, target_variance = 0.0;  // zero for a single place
  Matrix3d rotation = Matrix3d::Identity();             // target from source
  double correlation = 0.0;                             // mean of target . (rotation * source)
};

std::optional<Centered> AlignCentered(std::span<const Vector3d> source,
                                      std::span<const Vector3d> target,
                                      std::span<const double> weights) {
  ORB360_CHECK(source.size() == target.size(), source.size(), target.size());
  ORB360_CHECK(weights.empty() || weights.size() == source.size(), weights.size(), source.size());
  if (source.empty()) return std::nullopt;
  const double total = weights.empty() ? static_cast<double>(source.size())
                                       : std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto fraction_of = [&](size_t i) { return (weights.empty() ? 1.0 : weights[i]) / total; };
  Centered result{Vector3d::Zero(), Vector3d::Zero()};
  for (size_t i = 0; i < source.size(); ++i) {
    result.source_mean += fraction_of(i) * source[i];
    result.target_mean += fraction_of(i) * target[i];
  }
  if (!result.source_mean.allFinite() || !result.target_mean.allFinite()) return std::nullopt;

  Matrix3d covariance = Matrix3d::Zero();
  for (size_t i = 0; i < source.size(); ++i) {
    const Vector3d s = source[i] - result.source_mean;
    const Vector3d t = target[i] - result.target_mean;
    const double fraction = fraction_of(i);
    result.source_variance += fraction * s.squaredNorm();
    result.target_variance += fraction * t.squaredNorm();
    covariance += fraction * t * s.transpose();
  }
  const auto is_single_place = [](double variance, const Vector3d& mean) {
    return variance <= kSamePlace * kSamePlace * mean.squaredNorm();
  };
  if (is_single_place(result.source_variance, result.source_mean)) result.source_variance = 0.0;
  if (is_single_place(result.target_variance, result.target_mean)) result.target_variance = 0.0;
  if (result.source_variance == 0.0 || result.target_variance == 0.0) return result;

  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& singular = svd.singularValues();
  if (singular(1) <= kSameLine * singular(0)) {
    const Vector3d source_line = svd.matrixV().col(0), target_line = svd.matrixU().col(0);
    result.rotation =
        Eigen::Quaterniond::FromTwoVectors(source_line, target_line).toRotationMatrix();
    result.correlation = singular(0);
    return result;
  }
  // A negative sign means that a reflection would fit better; then the third axis is inverted.
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
  const Vector3d signs(1.0, 1.0, sign);
  result.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  result.correlation = singular.dot(signs);
  return result;
}

}  // namespace

std::optional<Rigid3> AlignRigid(std::span<const Vector3d> source,
                                 std::span<const Vector3d> target) {
  const auto centered = AlignCentered(source, target, {});
  if (!centered) return std::nullopt;
  return Rigid3{Eigen::Quaterniond(centered->rotation).normalized(),
                centered->target_mean - centered->rotation * centered->source_mean};
}

std::optional<Similarity3> AlignSimilarity(std::span<const Vector3d> source,
                                           std::span<const Vector3d> target,
                                           std::span<const double> weights) {
  const auto centered = AlignCentered(source, target, weights);
  if (!centered || !(centered->correlation > 0.0)) return std::nullopt;
  const double scale = centered->correlation / centered->source_variance;
  return Similarity3{scale, Eigen::Quaterniond(centered->rotation).normalized(),
                     centered->target_mean - scale * (centered->rotation * centered->source_mean)};
}

}  // namespace orb360
