#pragma once

#include <cstdint>
#include <span>

#include "slam/features/features.h"

namespace orb360 {

/// The two nearest of some descriptors. Distances are numbers of differing bits; kNone where there
/// is no such descriptor.
struct NearestTwo {
  static constexpr int kNone = 257;
  int best_index = -1;
  int second_index = -1;
  int best_distance = kNone;
  int second_distance = kNone;
};

/// Distance of one pair; for many use the functions below, which run on hardware popcount.
int HammingDistance(const Descriptor& a, const Descriptor& b);

/// The two nearest to `query` among descriptors[i] for i in `candidates`; the earlier candidate
/// wins a tie. The indices are elements of `candidates`.
NearestTwo FindNearestTwo(const Descriptor& query, std::span<const Descriptor> descriptors,
                          std::span<const int> candidates);

/// Distances from `query` to all `descriptors`; `distances` has their size.
void HammingDistances(const Descriptor& query, std::span<const Descriptor> descriptors,
                      std::span<uint16_t> distances);

}  // namespace orb360
