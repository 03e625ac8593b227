#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// Poses of the ground truth and of the estimate at the same time, each in its own world.
struct PosePair {
  /// Time of the ground truth, seconds.
  double timestamp = 0.0;
  Rigid3 truth_from_camera;
  Rigid3 estimate_from_camera;
};

/// Pairs poses by time (AssociateByTime), in the order of time.
std::vector<PosePair> PairPoses(std::span<const StampedPose> truth,
                                std::span<const StampedPose> estimate, double max_difference);

/// Statistics of a set of errors, metres.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
};

/// Throws ContractError for an empty set.
ErrorStatistics Summarize(std::span<const double> errors);

/// Relative pose error over pieces of the path, as defined by the KITTI odometry benchmark. For a
/// piece from pose i to pose j it is the motion (estimate_i^-1 estimate_j)^-1 truth_i^-1 truth_j;
/// its length and angle are divided by the piece's length and averaged over all pieces. A piece
/// begins at every tenth pose (at more when there are fewer than 1,000) and ends at the first pose
/// that is `piece_length` of the true path farther on.
struct RelativeError {
  /// Metres: 100, or half of the true path if that is shorter than 200 m.
  double piece_length = 0.0;
  size_t pieces = 0;
  /// Percent of the piece's length.
  double translation_percent = 0.0;
  double rotation_deg_per_m = 0.0;
};

/// Root mean square error of the motion from one pair to the next.
struct FrameError {
  double translation = 0.0;  ///< Metres.
  double rotation_deg = 0.0;
};

struct TrajectoryErrors {
  /// Absolute trajectory error, metres: the distances between the positions after the rigid motion,
  /// and after the similarity, that minimize their squares.
  ErrorStatistics ate_se3;
  ErrorStatistics ate_sim3;
  /// The similarity of ate_sim3. Its scale is the scale factor; 1 is perfect.
  Similarity3 truth_from_estimate;
  /// Relative errors of the estimate scaled by that factor, and of the unscaled estimate. (Relative
  /// motion is seen from the camera, so the rest of the alignment does not affect it.)
  RelativeError rpe;
  RelativeError rpe_raw;
  FrameError rpe_frame;
  /// The distances of ate_sim3, one for each pair.
  std::vector<double> position_errors;
};

/// Returns nullopt if no alignment is determined: fewer than three pairs, or all positions equal.
std::optional<TrajectoryErrors> EvaluateTrajectory(std::span<const PosePair> pairs);

}  // namespace orb360
