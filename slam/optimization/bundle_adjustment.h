#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"

namespace orb360 {

/// Poses, points and bearings that see them, by index. Solved in place.
struct BundleProblem {
  struct Observation {
    int pose;
    int point;
    Eigen::Vector3d bearing;  // unit, camera frame
    double sigma;             // angular noise, rad
  };
  /// A point of the ground: it lies `height` below the camera. See HeightResidual.
  struct Height {
    int pose;
    int point;
    Eigen::Vector3d normal;  // of the ground, unit, towards the camera, camera frame
    double height;
    double sigma;  // share of the height
  };
  /// A range that is known roughly, from completed depth. See RangeResidual.
  struct Range {
    int pose;
    int point;
    double range;
    double sigma;  // of its logarithm
  };
  std::vector<Rigid3> world_from_camera;
  std::vector<uint8_t> pose_fixed;  // by pose; at least one, or the gauge is free
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
  std::vector<Height> heights;
  std::vector<Range> ranges;
};

/// What an observation's error costs.
enum class BundleLoss {
  /// Grows like the error from one sigma on. Errors have heavier tails than a normal
  /// distribution's, since a corner is not quite the same point from everywhere: with a loss from
  /// the 95 % bound on (2.4 sigmas), a few corners of roofs and trees, seen from dozens of
  /// keyframes, decide how the scale drifts.
  kHuber,
  /// Has a limit, of which three sigmas cost 86 %: for poses that are nearly right and observations
  /// that are wrong altogether.
  kArctan,
};

struct BundleOptions {
  int max_iterations = 10;
  BundleLoss loss = BundleLoss::kHuber;
  /// The solver stops when an iteration lowers the cost by less than this share.
  double function_tolerance = 1e-4;
};

struct BundleReport {
  double initial_cost = 0;
  double final_cost = 0;
  int iterations = 0;
  bool usable = false;  // false: numerically failed, the problem is as it was
};

/// Bundle adjustment on tangent-plane residuals (bearing_residual.h; paper Eq. 11) by Levenberg and
/// Marquardt's method, damped as Ceres does it, with the points eliminated, on one thread.
/// Contract: indices are in range; every point is observed.
BundleReport SolveBundle(const BundleOptions& options, BundleProblem* problem);

/// Squared residual, in sigmas, of one observation; infinity where the point is on the other side
/// of the sphere than its bearing.
double SquaredResidual(const BundleProblem& problem, const BundleProblem::Observation& observation);

}  // namespace orb360
