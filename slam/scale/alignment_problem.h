#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/scale/position_alignment.h"
#include "slam/scale/scale_measurement.h"
#include "slam/scale/timed_path.h"
#include <orb360/slam/scale/position_fix.h>

namespace orb360 {

// The least-squares problem of AlignPositions, linearized around an estimate.

/// Unknowns: ln(scale), rotation, translation of the centre, clock offset.
inline constexpr int kAlignmentUnknowns = 8;
inline constexpr int kClockUnknown = 7;
using AlignmentVector = Eigen::Matrix<double, kAlignmentUnknowns, 1>;
using AlignmentMatrix = Eigen::Matrix<double, kAlignmentUnknowns, kAlignmentUnknowns>;
using AlignmentRow = Eigen::Matrix<double, 1, kAlignmentUnknowns>;

/// An estimate: local = scale * rotation * (path - center) + translation.
struct AlignmentState {
  double scale = 1;
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double clock = 0;  ///< Seconds to add to timestamps of fixes for those of the path.
};

/// The fixes that lie on the path at a clock offset, linearized.
struct LinearizedFixes {
  std::vector<double> times;               ///< Seconds, on the clock of the fixes.
  std::vector<Eigen::Vector3d> residuals;  ///< Fix less path, metres.
  /// Derivatives of the path by the unknowns.
  std::vector<Eigen::Matrix<double, 3, kAlignmentUnknowns>> rows;
  std::vector<double> sigmas, vertical_sigmas;  ///< Metres.
};

/// The problem: what stays the same in all rounds.
struct AlignmentProblem {
  std::span<const PathPoint> path;
  const Positions* positions;
  UpDirection up;
  std::optional<ScaleMeasurement> scale;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
};

/// Sums of weighted equations for a change of the estimate.
struct NormalEquations {
  AlignmentMatrix information = AlignmentMatrix::Zero();
  AlignmentVector right = AlignmentVector::Zero();

  void Add(const AlignmentRow& row, double residual, double sigma) {
    information += row.transpose() * row / (sigma * sigma);
    right += row.transpose() * (residual / (sigma * sigma));
  }
};

/// Linearizes all fixes that lie on the path.
LinearizedFixes Linearize(const AlignmentProblem& problem, const AlignmentState& state);

/// Multiplies the standard deviations of fixes by what a Cauchy loss makes of their residuals,
/// whose own spread is taken from their median. Returns the median of the horizontal distances,
/// metres.
double Reweight(LinearizedFixes* fixes);

/// Returns what is known apart from the horizontal fixes: heights, the vertical, the scale, the
/// clock.
NormalEquations PriorInformation(const AlignmentProblem& problem, const AlignmentState& state,
                                 const LinearizedFixes& fixes);

/// Adds a solution of the equations to an estimate, in steps of a limited length.
void Apply(const AlignmentVector& change, AlignmentState* state);

/// Finds the best heading, scale and translation at a clock offset, for a path that is levelled,
/// and sets the centre of the problem. Empty where too few fixes lie on the path.
std::optional<AlignmentState> StartAt(AlignmentProblem* problem, double clock);

}  // namespace orb360
