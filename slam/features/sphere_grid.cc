#include <algorithm>
#include <numbers>

#include <orb360/slam/features/sphere_grid.h>

namespace orb360 {
namespace {

constexpr double kPi = std::numbers::pi;
// A ring is 4 degrees high, so that a typical search window of tracking touches 4 to 9 cells.
constexpr int kRings = 45;
constexpr double kRingHeight = kPi / kRings;

double Latitude(const Eigen::Vector3d& b) { return std::asin(std::clamp(b.z(), -1.0, 1.0)); }

int RingOf(double latitude) {
  return std::clamp(static_cast<int>((latitude + 0.5 * kPi) / kRingHeight), 0, kRings - 1);
}

}  // namespace

SphereGrid::SphereGrid(std::span<const Eigen::Vector3d> bearings) {
  ring_start_.push_back(0);
  for (int ring = 0; ring < kRings; ++ring) {
    const double latitude = (ring + 0.5) * kRingHeight - 0.5 * kPi;
    const int cells = std::max(1, static_cast<int>(2 * kRings * std::cos(latitude)));
    ring_start_.push_back(ring_start_.back() + cells);
  }
  std::vector<int> cell_of(bearings.size());
  cell_start_.assign(ring_start_.back() + 1, 0);
  for (size_t i = 0; i < bearings.size(); ++i) {
    const Eigen::Vector3d& b = bearings[i];
    cell_of[i] = CellInRing(RingOf(Latitude(b)), std::atan2(b.y(), b.x()));
    ++cell_start_[cell_of[i] + 1];
  }
  for (size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
  order_.resize(bearings.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (size_t i = 0; i < bearings.size(); ++i) order_[next[cell_of[i]]++] = static_cast<int>(i);
}

int SphereGrid::CellInRing(int ring, double longitude) const {
  const int cells = ring_start_[ring + 1] - ring_start_[ring];
  const int cell = static_cast<int>((longitude + kPi) / (2 * kPi) * cells);
  return ring_start_[ring] + std::clamp(cell, 0, cells - 1);
}

void SphereGrid::Query(const Eigen::Vector3d& center, double radius,
                       std::vector<int>* indices) const {
  if (order_.empty()) return;
  if (radius > 0.5 * kPi) {
    indices->insert(indices->end(), order_.begin(), order_.end());
    return;
  }
  const double latitude = Latitude(center);
  const double longitude = std::atan2(center.y(), center.x());
  // Half of a cap's width in longitude: asin(sin r / cos lat), or the whole circle if it contains a
  // pole.
  const bool holds_pole = std::abs(latitude) + radius >= 0.5 * kPi;
  const double half_width =
      holds_pole ? kPi : std::asin(std::min(1.0, std::sin(radius) / std::cos(latitude)));
  const int last_ring = RingOf(latitude + radius);
  for (int ring = RingOf(latitude - radius); ring <= last_ring; ++ring) {
    const int first = ring_start_[ring];
    const int cells = ring_start_[ring + 1] - first;
    int begin = 0;
    int count = cells;
    if (half_width < kPi) {
      const double scale = cells / (2 * kPi);
      begin = static_cast<int>(std::floor((longitude - half_width + kPi) * scale));
      const int end = static_cast<int>(std::floor((longitude + half_width + kPi) * scale));
      count = std::min(cells, end - begin + 1);
    }
    for (int i = 0; i < count; ++i) {
      const int cell = first + ((begin + i) % cells + cells) % cells;
      indices->insert(indices->end(), order_.begin() + cell_start_[cell],
                      order_.begin() + cell_start_[cell + 1]);
    }
  }
}

}  // namespace orb360
