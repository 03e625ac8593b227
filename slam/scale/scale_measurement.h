#pragma once

namespace orb360 {

/// A measurement of ln(true length / length in the map).
struct ScaleMeasurement {
  double log_scale = 0;
  double sigma = 0;  ///< Standard deviation.
};

/// Joins two measurements with independent errors. Where they contradict each other by more than
/// three standard deviations, the result covers both (covariance union, Julier and Uhlmann), and
/// `is_conflict` is set.
ScaleMeasurement FuseScales(const ScaleMeasurement& a, const ScaleMeasurement& b,
                            bool* is_conflict);

}  // namespace orb360
