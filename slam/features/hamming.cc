#include "slam/features/hamming.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/features/hamming.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {

// Compiled once per target. From SSE4 on this uses the popcnt instruction.
HWY_INLINE int Distance(const Descriptor& a, const Descriptor& b) {
  return static_cast<int>(hwy::PopCount(a[0] ^ b[0]) + hwy::PopCount(a[1] ^ b[1]) +
                          hwy::PopCount(a[2] ^ b[2]) + hwy::PopCount(a[3] ^ b[3]));
}

int HammingDistance(const Descriptor& a, const Descriptor& b) { return Distance(a, b); }

NearestTwo FindNearestTwo(const Descriptor& query, std::span<const Descriptor> descriptors,
                          std::span<const int> candidates) {
  NearestTwo nearest;
  for (const int i : candidates) {
    const int distance = Distance(query, descriptors[i]);
    if (distance < nearest.best_distance) {
      nearest.second_distance = nearest.best_distance;
      nearest.second_index = nearest.best_index;
      nearest.best_distance = distance;
      nearest.best_index = i;
    } else if (distance < nearest.second_distance) {
      nearest.second_distance = distance;
      nearest.second_index = i;
    }
  }
  return nearest;
}

void HammingDistances(const Descriptor& query, std::span<const Descriptor> descriptors,
                      std::span<uint16_t> distances) {
  for (size_t i = 0; i < descriptors.size(); ++i) {
    distances[i] = static_cast<uint16_t>(Distance(query, descriptors[i]));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(HammingDistance);
HWY_EXPORT(FindNearestTwo);
HWY_EXPORT(HammingDistances);

int HammingDistance(const Descriptor& a, const Descriptor& b) {
  return HWY_DYNAMIC_DISPATCH(HammingDistance)(a, b);
}

NearestTwo FindNearestTwo(const Descriptor& query, std::span<const Descriptor> descriptors,
                          std::span<const int> candidates) {
  return HWY_DYNAMIC_DISPATCH(FindNearestTwo)(query, descriptors, candidates);
}

void HammingDistances(const Descriptor& query, std::span<const Descriptor> descriptors,
                      std::span<uint16_t> distances) {
  HWY_DYNAMIC_DISPATCH(HammingDistances)(query, descriptors, distances);
}

}  // namespace orb360
#endif
