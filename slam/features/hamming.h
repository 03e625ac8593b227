#pragma once

#include <cstdint>
#include <span>

#include <orb360/slam/features/features.h>

namespace orb360 {

/// The two nearest among some descriptors. Distances are numbers of differing bits, and kNone where
/// there is no such descriptor.
struct NearestTwo {
  static constexpr int kNone = 257;
  int best_index = -1;
  int second_index = -1;
  int best_distance = kNone;
  int second_distance = kNone;
};

/// Returns the distance of one pair. For many pairs use the functions below, which use hardware
/// popcount.
int HammingDistance(const Descriptor& a, const Descriptor& b);

/// Finds the two descriptors nearest to `query` among descriptors[i] for i in `candidates`. The
/// earlier candidate wins a tie. The returned indices are elements of `candidates`.
NearestTwo FindNearestTwo(const Descriptor& query, std::span<const Descriptor> descriptors,
                          std::span<const int> candidates);

/// Computes the distances from `query` to all `descriptors`; `distances` has the same size.
void HammingDistances(const Descriptor& query, std::span<const Descriptor> descriptors,
                      std::span<uint16_t> distances);

}  // namespace orb360
