#pragma once

#include <span>
#include <vector>

#include <orb360/slam/features/features.h>

namespace orb360 {

struct Match {
  int first;
  int second;
  int distance;  // differing bits
};

struct MatchOptions {
  /// Descriptors farther apart than this never match. Unrelated patches differ in about 128 of 256
  /// bits with a standard deviation of 8 to 20; correct matches differ in fewer than 60.
  int max_distance = 60;
  /// The distance of the best match may be at most this fraction of that of the second best.
  double ratio = 0.8;
  int num_threads = 1;  // of OpenMP; the result does not depend on it
};

/// Returns mutual nearest neighbours among all pairs of two sets of descriptors, ordered by
/// `first`.
std::vector<Match> MatchMutually(std::span<const Descriptor> first,
                                 std::span<const Descriptor> second, const MatchOptions& options);

/// Returns mutual nearest neighbours whose bearings differ by at most `radius` (radians), ordered
/// by `first`. The ratio test is applied only against a second best match of the same pyramid
/// level, because a corner is often found on two neighbouring levels.
std::vector<Match> MatchNearby(const Features& first, const Features& second, double radius,
                               const MatchOptions& options);

}  // namespace orb360
