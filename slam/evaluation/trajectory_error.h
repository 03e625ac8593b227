#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"
#include "slam/io/trajectory.h"

namespace orb360 {

/// A pose of the ground truth and the estimate for the same moment, each in its own world.
struct PosePair {
  /// Seconds, of the ground truth.
  double timestamp = 0.0;
  Rigid3 truth_from_camera;
  Rigid3 estimate_from_camera;
};

/// Pairs poses by time (AssociateByTime), in the order of time.
std::vector<PosePair> PairPoses(std::span<const StampedPose> truth,
                                std::span<const StampedPose> estimate, double max_difference);

/// Of a set of errors in metres.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
};

/// Throws ContractError for an empty set.
ErrorStatistics Summarize(std::span<const double> errors);

/// Relative pose error over pieces of the path, as the KITTI odometry benchmark defines it: for a
/// piece from pose i to pose j, the motion that is left of truth_i^-1 truth_j after undoing
/// estimate_i^-1 estimate_j, its length and angle divided by the piece's length. Means over all
/// pieces; the first pose of a piece is every tenth one (more often when there are fewer than
/// 1,000), its last the first one that is `piece_length` of the true path farther on.
struct RelativeError {
  /// Metres: 100, or half of the true path where that is less than 200 m long.
  double piece_length = 0.0;
  size_t pieces = 0;
  /// Percent of the piece's length.
  double translation_percent = 0.0;
  double rotation_deg_per_m = 0.0;
};

/// Errors between one pair and the next, root mean square.
struct FrameError {
  double translation = 0.0;  ///< Metres.
  double rotation_deg = 0.0;
};

struct TrajectoryErrors {
  /// Absolute trajectory error in metres: the distances that remain between the positions after
  /// the rigid motion, and the similarity, that minimize their squares.
  ErrorStatistics ate_se3;
  ErrorStatistics ate_sim3;
  /// That similarity. Its scale is the scale factor: 1 is perfect.
  Similarity3 truth_from_estimate;
  /// With the estimate scaled by that factor, and as it is. (Relative motion is seen from the
  /// camera, so the rest of the alignment does not matter to it.)
  RelativeError rpe;
  RelativeError rpe_raw;
  FrameError rpe_frame;
  /// The distances behind ate_sim3, one for each pair.
  std::vector<double> position_errors;
};

/// nullopt where no alignment is determined: fewer than three pairs, or all positions equal.
std::optional<TrajectoryErrors> EvaluateTrajectory(std::span<const PosePair> pairs);

}  // namespace orb360
