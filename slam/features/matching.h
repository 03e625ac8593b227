#pragma once

#include <span>
#include <vector>

#include "slam/features/features.h"

namespace orb360 {

struct Match {
  int first;
  int second;
  int distance;  // differing bits
};

struct MatchOptions {
  /// Descriptors farther apart than this never match. Of 256 bits about 128 differ between
  /// unrelated patches, with a standard deviation of 8 to 20; right matches lie below 60.
  int max_distance = 60;
  /// The best must be this much nearer than the second best.
  double ratio = 0.8;
  int num_threads = 1;  // of OpenMP; the result does not depend on it
};

/// Mutual nearest neighbours among all pairs of two sets of descriptors, ordered by `first`.
std::vector<Match> MatchMutually(std::span<const Descriptor> first,
                                 std::span<const Descriptor> second, const MatchOptions& options);

/// Mutual nearest neighbours whose bearings differ by at most `radius` (radians), ordered by
/// `first`. The ratio is asked only against a second best of the same pyramid level: a corner is
/// often found on two neighbouring levels.
std::vector<Match> MatchNearby(const Features& first, const Features& second, double radius,
                               const MatchOptions& options);

}  // namespace orb360
