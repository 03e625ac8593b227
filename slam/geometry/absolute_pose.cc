#include "slam/geometry/absolute_pose.h"

#include <array>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <opengv/absolute_pose/methods.hpp>

#include "slam/geometry/bearing.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t kSampleSize = 3;

/// A model: camera_from_world with its rotation as a matrix.
struct Model {
  Matrix3d rotation;
  Vector3d translation;
};

struct Correspondences {
  std::span<const Vector3d> points, bearings;
  Sigmas sigmas;
  const RansacOptions& options;

  size_t size() const { return points.size(); }
  double sigma(size_t i) const { return internal::SigmaOf(sigmas, i, options); }
};

/// Adapts a sample to the interface of OpenGV's minimal solver; the camera lies at its viewpoint.
class SampleAdapter : public opengv::absolute_pose::AbsoluteAdapterBase {
 public:
  explicit SampleAdapter(const Correspondences& data) : data_(data) {}
  Vector3d getBearingVector(size_t i) const override { return data_.bearings[i]; }
  double getWeight(size_t) const override { return 1.0; }
  Vector3d getCamOffset(size_t) const override { return Vector3d::Zero(); }
  Matrix3d getCamRotation(size_t) const override { return Matrix3d::Identity(); }
  Vector3d getPoint(size_t i) const override { return data_.points[i]; }
  size_t getNumberCorrespondences() const override { return data_.size(); }

 private:
  const Correspondences& data_;
};

/// Squared sine of the angle between bearing and point, in standard deviations. Infinite when the
/// point lies on the opposite side of the camera.
double SquaredError(const Correspondences& data, const Model& model, size_t i) {
  const Vector3d point = model.rotation * data.points[i] + model.translation;
  if (!(point.dot(data.bearings[i]) > 0.0)) return std::numeric_limits<double>::infinity();
  const double sigma = data.sigma(i);
  return point.cross(data.bearings[i]).squaredNorm() / (point.squaredNorm() * sigma * sigma);
}

/// One Gauss-Newton step on all correspondences, weighted by the loss. The transform is updated on
/// the left.
Model Refine(const Correspondences& data, const Model& model, const TukeyLoss& loss) {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (size_t i = 0; i < data.size(); ++i) {
    const double weight = loss.Weight(SquaredError(data, model, i));
    if (weight == 0.0) continue;
    // residual = tangent^T p / (|p| sigma), on the tangent plane of the bearing.
    const Vector3d point = model.rotation * data.points[i] + model.translation;
    const double range = point.norm();
    const Vector3d direction = point / range;
    const Eigen::Matrix<double, 2, 3> tangent = TangentBasis(data.bearings[i]).transpose();
    const Eigen::Vector2d across = tangent * direction;
    const double scale = 1.0 / data.sigma(i);
    // d direction = (I - direction direction^T) / range (omega x p + v)
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian.rightCols<3>() = (scale / range) * (tangent - across * direction.transpose());
    jacobian.leftCols<3>() = -jacobian.rightCols<3>() * Skew(point);
    hessian += weight * jacobian.transpose() * jacobian;
    gradient += (weight * scale) * jacobian.transpose() * across;
  }
  const Vector6d step = -hessian.ldlt().solve(gradient);
  if (!step.allFinite()) return model;
  const Matrix3d turn = ExpSo3(step.head<3>()).toRotationMatrix();
  return {turn * model.rotation, turn * model.translation + step.tail<3>()};
}

}  // namespace

std::optional<AbsolutePose> EstimateAbsolutePose(std::span<const Vector3d> points_world,
                                                 std::span<const Vector3d> bearings, Sigmas sigmas,
                                                 const RansacOptions& options) {
  const size_t count = points_world.size();
  ORB360_CHECK(bearings.size() == count, count, bearings.size());
  ORB360_CHECK(sigmas.empty() || sigmas.size() == count, count, sigmas.size());
  const Correspondences data{points_world, bearings, sigmas, options};
  const SampleAdapter adapter(data);
  const auto solve = [&](const std::array<int, kSampleSize>& sample, const auto& consider) {
    for (const Eigen::Matrix<double, 3, 4>& world_from_camera :
         opengv::absolute_pose::p3p_kneip(adapter, sample[0], sample[1], sample[2])) {
      // The solver returns the nearest real number for a complex root; such a pose does not fit the
      // sample.
      if (!world_from_camera.allFinite()) continue;
      const Matrix3d rotation = Eigen::Quaterniond(world_from_camera.leftCols<3>().transpose())
                                    .normalized()
                                    .toRotationMatrix();
      consider(Model{rotation, -(rotation * world_from_camera.col(3))});
    }
  };
  const auto error = [&](const Model& model, size_t i) { return SquaredError(data, model, i); };
  const auto refine = [&](const Model& model, const TukeyLoss& loss) {
    return Refine(data, model, loss);
  };
  const auto model = Ransac<Model, kSampleSize>(count, options, solve, error, refine);
  if (!model) return std::nullopt;

  const double inlier_limit = options.max_error * options.max_error;
  AbsolutePose result;
  result.camera_from_world = {Eigen::Quaterniond(model->rotation).normalized(), model->translation};
  result.inliers.resize(count);
  for (size_t i = 0; i < count; ++i) {
    result.inliers[i] = error(*model, i) < inlier_limit;
    result.num_inliers += result.inliers[i];
  }
  if (result.num_inliers < options.min_inliers) return std::nullopt;
  return result;
}

}  // namespace orb360
