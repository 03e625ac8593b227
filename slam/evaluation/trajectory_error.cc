#include "slam/evaluation/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "slam/evaluation/association.h"
#include "slam/geometry/alignment.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr double kPieceLength = 100.0;  // metres
constexpr size_t kPieceStep = 10;       // poses from one piece's start to the next's, as in KITTI
constexpr size_t kLeastStarts = 100;    // a shorter trajectory starts pieces more often

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::vector<double> Times(std::span<const StampedPose> poses) {
  std::vector<double> times;
  times.reserve(poses.size());
  for (const StampedPose& pose : poses) times.push_back(pose.timestamp);
  return times;
}

/// Returns the error of the motion from `a` to `b`: the inverse of the estimated motion, with
/// translations multiplied by `scale`, times the true one.
Rigid3 MotionError(const PosePair& a, const PosePair& b, double scale) {
  const Rigid3 truth = a.truth_from_camera.Inverse() * b.truth_from_camera;
  Rigid3 estimate = a.estimate_from_camera.Inverse() * b.estimate_from_camera;
  estimate.translation *= scale;
  return estimate.Inverse() * truth;
}

double AngleOf(const Rigid3& motion) { return LogSo3(motion.rotation).norm(); }

/// Returns the distance along the true path from the first pair to each pair.
std::vector<double> PathLengths(std::span<const PosePair> pairs) {
  std::vector<double> lengths = {0.0};
  for (size_t i = 1; i < pairs.size(); ++i) {
    lengths.push_back(lengths.back() + (pairs[i].truth_from_camera.translation -
                                        pairs[i - 1].truth_from_camera.translation)
                                           .norm());
  }
  return lengths;
}

RelativeError ErrorOfPieces(std::span<const PosePair> pairs, double scale) {
  const std::vector<double> lengths = PathLengths(pairs);
  RelativeError error;
  error.piece_length = std::min(kPieceLength, 0.5 * lengths.back());
  const size_t step = std::clamp<size_t>(pairs.size() / kLeastStarts, 1, kPieceStep);
  for (size_t i = 0; i < pairs.size(); i += step) {
    const auto end = std::ranges::lower_bound(lengths, lengths[i] + error.piece_length);
    if (end == lengths.end()) break;
    const size_t j = static_cast<size_t>(end - lengths.begin());
    const double length = lengths[j] - lengths[i];
    const Rigid3 left = MotionError(pairs[i], pairs[j], scale);
    error.translation_percent += 100.0 * left.translation.norm() / length;
    error.rotation_deg_per_m += kDegrees * AngleOf(left) / length;
    ++error.pieces;
  }
  error.translation_percent /= static_cast<double>(error.pieces);
  error.rotation_deg_per_m /= static_cast<double>(error.pieces);
  return error;
}

FrameError ErrorOfFrames(std::span<const PosePair> pairs, double scale) {
  double squared_translation = 0.0;
  double squared_angle = 0.0;
  for (size_t i = 1; i < pairs.size(); ++i) {
    const Rigid3 left = MotionError(pairs[i - 1], pairs[i], scale);
    squared_translation += left.translation.squaredNorm();
    squared_angle += AngleOf(left) * AngleOf(left);
  }
  const double count = static_cast<double>(pairs.size() - 1);
  return {std::sqrt(squared_translation / count), kDegrees * std::sqrt(squared_angle / count)};
}

template <typename Transform>
std::vector<double> Distances(std::span<const Eigen::Vector3d> truth,
                              std::span<const Eigen::Vector3d> estimate,
                              const Transform& truth_from_estimate) {
  std::vector<double> distances;
  distances.reserve(truth.size());
  for (size_t i = 0; i < truth.size(); ++i) {
    distances.push_back((truth[i] - truth_from_estimate * estimate[i]).norm());
  }
  return distances;
}

}  // namespace

std::vector<PosePair> PairPoses(std::span<const StampedPose> truth,
                                std::span<const StampedPose> estimate, double max_difference) {
  std::vector<PosePair> pairs;
  for (const auto [i, j] : AssociateByTime(Times(truth), Times(estimate), max_difference)) {
    pairs.push_back(
        {truth[i].timestamp, truth[i].world_from_camera, estimate[j].world_from_camera});
  }
  return pairs;
}

ErrorStatistics Summarize(std::span<const double> errors) {
  ORB360_CHECK(!errors.empty());
  const double count = static_cast<double>(errors.size());
  std::vector<double> sorted(errors.begin(), errors.end());
  std::ranges::sort(sorted);
  const size_t middle = sorted.size() / 2;
  return {std::sqrt(std::inner_product(sorted.begin(), sorted.end(), sorted.begin(), 0.0) / count),
          std::accumulate(sorted.begin(), sorted.end(), 0.0) / count,
          sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]),
          sorted.back()};
}

std::optional<TrajectoryErrors> EvaluateTrajectory(std::span<const PosePair> pairs) {
  if (pairs.size() < 3) return std::nullopt;
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
  for (const PosePair& pair : pairs) {
    truth.push_back(pair.truth_from_camera.translation);
    estimate.push_back(pair.estimate_from_camera.translation);
  }
  const std::optional<Rigid3> rigid = AlignRigid(estimate, truth);
  const std::optional<Similarity3> similarity = AlignSimilarity(estimate, truth);
  if (!rigid || !similarity) return std::nullopt;

  TrajectoryErrors errors;
  errors.ate_se3 = Summarize(Distances(truth, estimate, *rigid));
  errors.position_errors = Distances(truth, estimate, *similarity);
  errors.ate_sim3 = Summarize(errors.position_errors);
  errors.truth_from_estimate = *similarity;
  errors.rpe = ErrorOfPieces(pairs, similarity->scale);
  errors.rpe_raw = ErrorOfPieces(pairs, 1.0);
  errors.rpe_frame = ErrorOfFrames(pairs, similarity->scale);
  return errors;
}

}  // namespace orb360
