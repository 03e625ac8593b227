#include "slam/io/lenses/lens_estimation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "nn/base/statistics.h"

namespace orb360 {
namespace {

/// Rotation vector of the second lens, centre of each lens, logarithm of each focal length: changes
/// from the start.
constexpr int kParameters = 9;
using Parameters = Eigen::Matrix<double, kParameters, 1>;

LensCalibration Changed(const LensCalibration& start, const Parameters& change) {
  LensCalibration changed = start;
  const Eigen::Vector3d rotation = change.head<3>();
  if (const double angle = rotation.norm(); angle > 0.0) {
    changed.lenses[1].camera_from_lens =
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle)) *
        start.lenses[1].camera_from_lens;
  }
  for (int i = 0; i < 2; ++i) {
    changed.lenses[i].center += change.segment<2>(3 + 2 * i);
    changed.lenses[i].focal *= std::exp(change[7 + i]);
  }
  return changed;
}

/// Standard deviations of the changes before anything was seen.
Parameters PriorDeviations(const LensCalibration& start) {
  constexpr double kRotation = 2.0 * std::numbers::pi / 180.0;
  constexpr double kCenter = 0.005;  // of the image's size
  constexpr double kFocal = 0.01;
  Parameters deviations;
  deviations.head<3>().setConstant(kRotation);
  for (int i = 0; i < 2; ++i) {
    const cv::Size size = start.lenses[i].size;
    deviations.segment<2>(3 + 2 * i).setConstant(kCenter * std::max(size.width, size.height));
    deviations[7 + i] = kFocal;
  }
  return deviations;
}

/// Difference of the unit directions in which both lenses see a match.
Eigen::Vector3d Difference(const LensCalibration& calibration, const LensMatch& match) {
  const auto direction = [&](int i) {
    const FisheyeLens& lens = calibration.lenses[i];
    return Eigen::Vector3d(lens.camera_from_lens * Unproject(lens, match.pixel[i]));
  };
  return direction(0) - direction(1);
}

std::vector<double> Angles(const LensCalibration& calibration, std::span<const LensMatch> matches) {
  std::vector<double> angles;
  for (const LensMatch& match : matches) {
    angles.push_back(2.0 * std::asin(std::min(1.0, 0.5 * Difference(calibration, match).norm())));
  }
  return angles;
}

/// One step of Gauss and Newton with weights by Cauchy's loss of width `width`, radians.
Parameters Step(const LensCalibration& start, const Parameters& change,
                std::span<const LensMatch> matches, double width) {
  const Parameters deviations = PriorDeviations(start);
  const LensCalibration present = Changed(start, change);
  std::vector<LensCalibration> beside;
  constexpr double kDelta = 1e-4;  // of a prior deviation, for the numeric derivative
  for (int i = 0; i < kParameters; ++i) {
    Parameters other = change;
    other[i] += kDelta * deviations[i];
    beside.push_back(Changed(start, other));
  }
  Eigen::Matrix<double, kParameters, kParameters> normal =
      deviations.cwiseAbs2().cwiseInverse().asDiagonal();
  Parameters gradient = change.cwiseQuotient(deviations.cwiseAbs2());
  for (const LensMatch& match : matches) {
    const Eigen::Vector3d difference = Difference(present, match);
    Eigen::Matrix<double, 3, kParameters> jacobian;
    for (int i = 0; i < kParameters; ++i) {
      jacobian.col(i) = (Difference(beside[i], match) - difference) / (kDelta * deviations[i]);
    }
    const double weight = 1.0 / (width * width + difference.squaredNorm());
    normal += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * difference;
  }
  return change - normal.ldlt().solve(gradient);
}

}  // namespace

Eigen::Vector3d Unproject(const FisheyeLens& lens, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d offset = pixel - lens.center;
  const double radius = offset.norm();
  if (radius == 0.0) return Eigen::Vector3d::UnitZ();
  // Bisection, because the polynomial may be anything beyond the rim.
  double low = 0.0;
  double high = std::numbers::pi;
  constexpr int kSteps = 50;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = 0.5 * (low + high);
    (lens.Radius(middle) < radius ? low : high) = middle;
  }
  const double angle = 0.5 * (low + high);
  Eigen::Vector3d ray;
  ray << std::sin(angle) / radius * offset, std::cos(angle);
  return ray;
}

std::optional<LensEstimate> EstimateLenses(const LensCalibration& start,
                                           std::span<const LensMatch> matches) {
  constexpr size_t kMinMatches = 50;
  constexpr int kIterations = 20;
  if (matches.size() < kMinMatches) return std::nullopt;
  LensEstimate estimate{start, static_cast<int>(matches.size()), 0.0, 0.0};
  estimate.median_before = Median(Angles(start, matches));
  Parameters change = Parameters::Zero();
  const double pixel = 1.0 / start.lenses[0].focal;  // radians
  for (int i = 0; i < kIterations; ++i) {
    // The loss narrows with the errors, to half a pixel.
    const double width = std::max(0.5 * pixel, Median(Angles(Changed(start, change), matches)));
    change = Step(start, change, matches, width);
  }
  estimate.calibration = Changed(start, change);
  estimate.median_after = Median(Angles(estimate.calibration, matches));
  return estimate;
}

}  // namespace orb360
