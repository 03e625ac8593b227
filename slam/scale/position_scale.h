#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include <orb360/slam/scale/position_fix.h>

namespace orb360 {

/// A place on an estimated path.
struct PathPoint {
  double timestamp;          ///< Seconds.
  Eigen::Vector3d position;  ///< In the map's unit of length.
};

/// A measurement of ln(true length / length in the map).
struct ScaleMeasurement {
  double log_scale = 0;
  double sigma = 0;  ///< Standard deviation.
};

/// Measures the scale of a path by positions that something else has measured: the similarity
/// between both, with Huber's loss. `path` is in the order of time; between its points it is taken
/// as straight, and fixes where two points are more than two seconds apart are not used. Errors of
/// receivers are alike for seconds, so fixes within ten seconds count as one. Where the residuals
/// are larger than the fixes' standard deviations, the result's is larger in proportion (Birge's
/// ratio). Empty where the fixes do not tell the scale within a factor of e. Throws ContractError
/// for a fix that is not valid.
std::optional<ScaleMeasurement> MeasureScaleByPositions(std::span<const PathPoint> path,
                                                        std::span<const PositionFix> fixes);

/// Joins two measurements with independent errors. Where they contradict each other by more than
/// three standard deviations, the result covers both (covariance union, Julier and Uhlmann), and
/// `is_conflict` is set.
ScaleMeasurement FuseScales(const ScaleMeasurement& a, const ScaleMeasurement& b,
                            bool* is_conflict);

}  // namespace orb360
