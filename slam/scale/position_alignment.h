#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/scale/scale_measurement.h"
#include "slam/scale/timed_path.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/scale/position_fix.h>

namespace orb360 {

/// Fewest fixes on the path that AlignPositions uses.
inline constexpr size_t kMinAlignmentFixes = 6;

/// The vertical in the frame of a path, and how well it is known.
struct UpDirection {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< Unit, towards the sky.
  double sigma = 0.5;  ///< Standard deviation in each of the two directions, radians, positive.
};

/// Standard deviations of a vertical, radians: the normal of the ground, which slopes as roads do;
/// the upper side of a camera that somebody carries.
inline constexpr double kGroundUpSigma = 0.05;
inline constexpr double kCameraUpSigma = 0.5;

/// What is known of the errors of the fixes.
struct FixNoise {
  double sigma = 0;                ///< In each horizontal direction, metres.
  double correlated_fraction = 0;  ///< Of the variance: CorrelatedNoise.
  double correlation_time = 0;     ///< Seconds.
};

/// Where a path lies on Earth. Standard deviations follow from the fixes and from nothing else: an
/// error that all fixes share does not show.
struct PositionAlignment {
  Similarity3 local_from_path;  ///< To metres east, north and up.
  double log_scale_sigma = 0;   ///< Of ln(local_from_path.scale).
  double heading_sigma = 0;     ///< Of the rotation about the vertical, radians.
  double tilt_sigma = 0;        ///< Of the rotation about horizontal axes, the larger one, radians.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< Mean of the path where there are fixes.
  double horizontal_sigma = 0;                       ///< Of the centre, in each direction, metres.
  double vertical_sigma = 0;      ///< Of the centre, metres; infinite where no fix has a height.
  double clock_offset = 0;        ///< Seconds to add to timestamps of fixes for those of the path.
  double clock_offset_sigma = 0;  ///< Seconds.
  FixNoise noise;
  double median_distance = 0;  ///< Between fixes and path, horizontally, metres.
  int num_fixes = 0;           ///< During the path.
};

/// Why a path cannot be aligned.
enum class AlignmentFailure {
  kNone,
  kTooFewFixes,  ///< Fewer than six fixes during the path.
  kStandstill,   ///< Path or fixes hardly move in comparison with the errors of the fixes.
  kNotThisPath,  ///< The fixes describe another path.
  kManyOffsets,  ///< The path fits at several offsets between the clocks equally well.
};

/// An alignment, or why there is none.
struct AlignmentResult {
  std::optional<PositionAlignment> alignment;
  AlignmentFailure failure = AlignmentFailure::kNone;
  double median_distance = 0;  ///< Of kNotThisPath: of the best fit, metres.
};

/// Finds the similarity between a path, whose times ascend, and positions, and the offset between
/// their clocks. It is the maximum a posteriori of the fixes, the vertical and the clock, with a
/// Cauchy loss. The errors of the fixes are white noise and a first-order Gauss-Markov process
/// (CorrelatedNoise); fractions, correlation times from 5 to 600 s and a factor of the stated
/// standard deviations are averaged, each weighted by its restricted likelihood (Patterson and
/// Thompson 1971), so that standard deviations also contain how little a short track tells of the
/// noise. `scale`: what else is known of ln(metres / unit of the path). Deterministic. Throws
/// ContractError for a fix that is not valid.
AlignmentResult AlignPositions(std::span<const PathPoint> path, const Positions& positions,
                               const UpDirection& up,
                               const std::optional<ScaleMeasurement>& scale = std::nullopt);

}  // namespace orb360
