#include "slam/geometry/cluster_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Bands between equally spaced heights on the unit sphere have equal areas (Archimedes). A cell is
// about 12 degrees wide.
constexpr int kRows = 12;
constexpr int kColumns = 24;
// Intraclass correlation of the errors in a cell.
constexpr double kCorrelation = 0.1;

int CellOf(const Eigen::Vector3d& bearing) {
  const double column = (std::atan2(bearing.y(), bearing.x()) / std::numbers::pi + 1) / 2;
  const auto index = [](double fraction, int count) {
    return std::clamp(static_cast<int>(fraction * count), 0, count - 1);
  };
  return index((bearing.z() + 1) / 2, kRows) * kColumns + index(column, kColumns);
}

using Counts = std::array<int, static_cast<size_t>(kRows) * kColumns>;

Counts CountActive(std::span<const int> cells, std::span<const uint8_t> active) {
  ORB360_CHECK(cells.size() == active.size(), cells.size(), active.size());
  Counts counts{};
  for (size_t i = 0; i < cells.size(); ++i) counts[cells[i]] += active[i] != 0;
  return counts;
}

double WeightInCell(int count) { return 1 / (1 + kCorrelation * std::max(0, count - 1)); }

}  // namespace

ClusterWeights::ClusterWeights(std::span<const Eigen::Vector3d> bearings) {
  cells_.reserve(bearings.size());
  for (const Eigen::Vector3d& bearing : bearings) cells_.push_back(CellOf(bearing));
}

std::vector<double> ClusterWeights::Weights(std::span<const uint8_t> active) const {
  const Counts counts = CountActive(cells_, active);
  std::vector<double> weights;
  weights.reserve(cells_.size());
  for (const int cell : cells_) weights.push_back(WeightInCell(counts[cell]));
  return weights;
}

double ClusterWeights::EffectiveCount(std::span<const uint8_t> active) const {
  double sum = 0;
  for (const int count : CountActive(cells_, active)) sum += count * WeightInCell(count);
  return sum;
}

}  // namespace orb360
