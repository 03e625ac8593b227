#include "slam/geometry/essential_matrix.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <opengv/relative_pose/methods.hpp>

#include "nn/base/statistics.h"
#include "slam/geometry/bearing.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t kSampleSize = 5;

struct Correspondences {
  std::span<const Vector3d> bearings1, bearings2;
  Sigmas sigmas1, sigmas2;
  const RansacOptions& options;

  size_t size() const { return bearings1.size(); }
  double variance1(size_t i) const {
    const double sigma = internal::SigmaOf(sigmas1, i, options);
    return sigma * sigma;
  }
  double variance2(size_t i) const {
    const double sigma = internal::SigmaOf(sigmas2, i, options);
    return sigma * sigma;
  }
};

/// Adapts a sample to the interface of OpenGV's minimal solver; the cameras lie at their
/// viewpoints.
class SampleAdapter : public opengv::relative_pose::RelativeAdapterBase {
 public:
  explicit SampleAdapter(const Correspondences& data) : data_(data) {}
  Vector3d getBearingVector1(size_t i) const override { return data_.bearings1[i]; }
  Vector3d getBearingVector2(size_t i) const override { return data_.bearings2[i]; }
  double getWeight(size_t) const override { return 1.0; }
  Vector3d getCamOffset1(size_t) const override { return Vector3d::Zero(); }
  Matrix3d getCamRotation1(size_t) const override { return Matrix3d::Identity(); }
  Vector3d getCamOffset2(size_t) const override { return Vector3d::Zero(); }
  Matrix3d getCamRotation2(size_t) const override { return Matrix3d::Identity(); }
  size_t getNumberCorrespondences() const override { return data_.size(); }

 private:
  const Correspondences& data_;
};

/// A pose with the quantities from which its errors are computed.
struct Model {
  Matrix3d rotation;      // camera 1 from camera 2
  Vector3d translation;   // unit
  Matrix3d essential;     // [translation]x rotation
  Vector3d translation2;  // the same direction in camera 2

  Model(const Matrix3d& r, const Vector3d& t)
      : rotation(r), translation(t), essential(Skew(t) * r), translation2(r.transpose() * t) {}
};

/// Squared error of a correspondence, in standard deviations (see EstimateRelativePose).
double SquaredError(const Correspondences& data, const Model& model, size_t i, double limit) {
  const Vector3d& bearing1 = data.bearings1[i];
  const Vector3d& bearing2 = data.bearings2[i];
  const double along1 = model.translation.dot(bearing1);
  const double along2 = model.translation2.dot(bearing2);
  const double triple = bearing1.dot(model.essential * bearing2);
  const double variance1 = data.variance1(i), variance2 = data.variance2(i);
  const double squared =
      triple * triple / (variance1 * (1.0 - along2 * along2) + variance2 * (1.0 - along1 * along1));
  if (!(squared < limit)) return limit;
  // The ranges along the bearings, times the positive number |b1 x R b2|^2 / |t|.
  const double cosine = bearing1.dot(model.rotation * bearing2);
  const double range1 = along1 - along2 * cosine;
  const double range2 = along1 * cosine - along2;
  if (range1 >= 0.0 && range2 >= 0.0) return squared;
  const double squared_angle = 2.0 * (1.0 - cosine);  // of parallel rays, all that pass
  return std::max(squared, squared_angle / (variance1 + variance2));
}

/// Passes on the two rotations and two translations of an essential matrix (Horn, Recovering
/// Baseline and Orientation from Essential Matrix, 1990): R = cofactors(E) -+ [t]x E for |t| = 1.
template <typename Consider>
void Decompose(const Matrix3d& essential, const Consider& consider) {
  const Matrix3d scaled = essential * (std::sqrt(2.0) / essential.norm());
  const Vector3d crosses[] = {scaled.col(0).cross(scaled.col(1)),
                              scaled.col(1).cross(scaled.col(2)),
                              scaled.col(2).cross(scaled.col(0))};
  const Vector3d translation =
      std::max({crosses[0], crosses[1], crosses[2]}, [](const Vector3d& a, const Vector3d& b) {
        return a.squaredNorm() < b.squaredNorm();
      }).normalized();
  Matrix3d cofactors;
  cofactors << crosses[1], crosses[2], crosses[0];
  const Matrix3d turned = Skew(translation) * scaled;
  for (const Matrix3d& rotation : {Matrix3d(cofactors - turned), Matrix3d(cofactors + turned)}) {
    const Matrix3d orthonormal = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    consider(Model(orthonormal, translation));
    consider(Model(orthonormal, -translation));
  }
}

/// Largest squared parallax (of the chord) that has full weight while the model is still coarse.
///
/// A correspondence determines the translation in proportion to its parallax. Where most points are
/// far away, a single wrong match could outweigh all others and keep a poor model. Until the last
/// steps, points nearer than a quarter of the median range therefore have the weight of a point at
/// that range.
double SquaredParallaxBound(const Correspondences& data, const Model& model,
                            const TukeyLoss& loss) {
  constexpr double kTimesMedian = 4.0;
  std::vector<double> squared_parallax;
  squared_parallax.reserve(data.size());
  for (size_t i = 0; i < data.size(); ++i) {
    if (!(SquaredError(data, model, i, loss.limit()) < loss.limit())) continue;
    squared_parallax.push_back(
        (data.bearings1[i] - model.rotation * data.bearings2[i]).squaredNorm());
  }
  if (squared_parallax.empty()) return 0.0;
  return kTimesMedian * kTimesMedian * Median(squared_parallax);
}

/// One Gauss-Newton step on all correspondences, weighted by the loss. The rotation is updated on
/// the left, the translation on the sphere.
Model Refine(const Correspondences& data, const Model& model, const TukeyLoss& loss) {
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  const Eigen::Matrix<double, 3, 2> tangent = TangentBasis(model.translation);
  const Vector3d& t = model.translation;
  const double parallax_bound = loss.is_wide() ? SquaredParallaxBound(data, model, loss)
                                               : std::numeric_limits<double>::infinity();
  Matrix5d hessian = Matrix5d::Zero();
  Vector5d gradient = Vector5d::Zero();
  for (size_t i = 0; i < data.size(); ++i) {
    const double squared = SquaredError(data, model, i, loss.limit());
    double weight = loss.Weight(squared);
    if (weight == 0.0) continue;
    // residual = triple / sqrt(variance)
    const Vector3d& b1 = data.bearings1[i];
    const Vector3d b2 = model.rotation * data.bearings2[i];
    const Vector3d normal = b2.cross(b1);
    const double triple = t.dot(normal);
    const double squared_parallax = (b1 - b2).squaredNorm();
    if (squared_parallax > parallax_bound) weight *= parallax_bound / squared_parallax;
    const double along1 = t.dot(b1), along2 = t.dot(b2);
    const double variance1 = data.variance1(i), variance2 = data.variance2(i);
    const double variance =
        variance1 * (1.0 - along2 * along2) + variance2 * (1.0 - along1 * along1);
    const double scale = 1.0 / std::sqrt(variance);
    const double residual = triple * scale;
    // The variance's derivative keeps the estimate unbiased at low parallax:
    // d variance = -2 along2 variance1 d along2 - 2 along1 variance2 d along1
    const double by_along = residual * scale * scale;
    Vector5d jacobian;
    jacobian.head<3>() =
        scale * b2.cross(b1.cross(t)) + by_along * along2 * variance1 * b2.cross(t);
    jacobian.tail<2>() =
        tangent.transpose() *
        (scale * normal + by_along * (along2 * variance1 * b2 + along1 * variance2 * b1));
    hessian.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
    gradient += weight * residual * jacobian;
  }
  // A small damping is needed because without translation its direction is undetermined.
  constexpr double kDamping = 1e-6;
  hessian.diagonal() *= 1.0 + kDamping;
  hessian.diagonal().array() += kDamping;
  const Vector5d step = -hessian.selfadjointView<Eigen::Lower>().ldlt().solve(gradient);
  if (!step.allFinite()) return model;
  return Model((ExpSo3(step.head<3>()).toRotationMatrix() * model.rotation),
               (t + tangent * step.tail<2>()).normalized());
}

}  // namespace

std::optional<RelativePose> EstimateRelativePose(std::span<const Vector3d> bearings1,
                                                 std::span<const Vector3d> bearings2,
                                                 Sigmas sigmas1, Sigmas sigmas2,
                                                 const RansacOptions& options) {
  const size_t count = bearings1.size();
  ORB360_CHECK(bearings2.size() == count, count, bearings2.size());
  ORB360_CHECK(sigmas1.empty() || sigmas1.size() == count, count, sigmas1.size());
  ORB360_CHECK(sigmas2.empty() || sigmas2.size() == count, count, sigmas2.size());
  const Correspondences data{bearings1, bearings2, sigmas1, sigmas2, options};
  const double limit = TukeyLoss(options).limit();
  const SampleAdapter adapter(data);
  const auto solve = [&](const std::array<int, kSampleSize>& sample, const auto& consider) {
    const std::vector<int> indices(sample.begin(), sample.end());
    for (const Eigen::Matrix3cd& solution :
         opengv::relative_pose::fivept_stewenius(adapter, indices)) {
      // A complex pair of roots gives no pose. Real roots have an imaginary part from rounding.
      if (!(solution.imag().squaredNorm() < 1e-12 * solution.real().squaredNorm())) continue;
      Decompose(solution.real(), [&](const Model& model) {
        if (std::all_of(sample.begin(), sample.end(),
                        [&](int i) { return SquaredError(data, model, i, limit) < limit; })) {
          consider(model);
        }
      });
    }
  };
  const auto error = [&](const Model& model, size_t i) {
    return SquaredError(data, model, i, limit);
  };
  const auto refine = [&](const Model& model, const TukeyLoss& loss) {
    return Refine(data, model, loss);
  };
  const auto model = Ransac<Model, kSampleSize>(count, options, solve, error, refine);
  if (!model) return std::nullopt;

  const double inlier_limit = options.max_error * options.max_error;
  std::vector<bool> inliers(count);
  for (size_t i = 0; i < count; ++i) inliers[i] = error(*model, i) < inlier_limit;
  const auto num_inliers = static_cast<int>(std::count(inliers.begin(), inliers.end(), true));
  if (num_inliers < options.min_inliers) return std::nullopt;
  return RelativePose{{Eigen::Quaterniond(model->rotation).normalized(), model->translation},
                      std::move(inliers),
                      num_inliers};
}

}  // namespace orb360
