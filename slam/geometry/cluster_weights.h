#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// Weights of bearings whose errors are not independent. Bearings close to each other often show
/// one object, which moves as a whole, or one place of the lens or the stitching seam; an object
/// rich in corners would outvote everything else. The sphere is divided into 288 cells of equal
/// solid angle. Errors within a cell have an intraclass correlation of 0.1, so n bearings of a cell
/// weigh as much as n / (1 + 0.1 (n - 1)) independent ones (Kish's design effect).
class ClusterWeights {
 public:
  explicit ClusterWeights(std::span<const Eigen::Vector3d> bearings);

  /// Returns the weight of each bearing if only those with `active` (one per bearing) count.
  std::vector<double> Weights(std::span<const uint8_t> active) const;
  /// Returns the sum of the weights of the active bearings: the number of independent bearings that
  /// would weigh as much.
  double EffectiveCount(std::span<const uint8_t> active) const;

 private:
  std::vector<int> cells_;  // by bearing
};

}  // namespace orb360
