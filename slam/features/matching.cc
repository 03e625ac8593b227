#include "slam/features/matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "slam/features/hamming.h"

namespace orb360 {
namespace {

bool IsDistinct(const NearestTwo& nearest, const MatchOptions& options) {
  return nearest.best_distance <= options.max_distance &&
         nearest.best_distance < options.ratio * nearest.second_distance;
}

// Keeps matches that are mutually best: `forward` and `backward` hold the best match in the other
// set.
std::vector<Match> KeepMutual(const std::vector<NearestTwo>& forward,
                              const std::vector<int>& backward) {
  std::vector<Match> matches;
  for (size_t i = 0; i < forward.size(); ++i) {
    const int j = forward[i].best_index;
    if (j >= 0 && backward[j] == static_cast<int>(i)) {
      matches.push_back({static_cast<int>(i), j, forward[i].best_distance});
    }
  }
  return matches;
}

// Finds, for each feature of `from`, the nearest two features of `to` within the radius.
std::vector<NearestTwo> FindNearby(const Features& from, const Features& to, double radius,
                                   int num_threads) {
  std::vector<NearestTwo> nearest(from.size());
  const double min_cosine = std::cos(std::min(radius, std::numbers::pi));
#pragma omp parallel num_threads(num_threads)
  {
    std::vector<int> candidates;
#pragma omp for schedule(static)
    for (int i = 0; i < from.size(); ++i) {
      candidates.clear();
      to.grid.Query(from.bearings[i], radius, &candidates);
      std::erase_if(candidates,
                    [&](int j) { return to.bearings[j].dot(from.bearings[i]) < min_cosine; });
      nearest[i] = FindNearestTwo(from.descriptors[i], to.descriptors, candidates);
    }
  }
  return nearest;
}

}  // namespace

std::vector<Match> MatchMutually(std::span<const Descriptor> first,
                                 std::span<const Descriptor> second, const MatchOptions& options) {
  std::vector<int> all_second(second.size());
  std::iota(all_second.begin(), all_second.end(), 0);
  std::vector<int> all_first(first.size());
  std::iota(all_first.begin(), all_first.end(), 0);
  std::vector<NearestTwo> forward(first.size());
  std::vector<int> backward(second.size(), -1);
#pragma omp parallel num_threads(options.num_threads)
  {
#pragma omp for schedule(static)
    for (size_t i = 0; i < first.size(); ++i) {
      forward[i] = FindNearestTwo(first[i], second, all_second);
      if (!IsDistinct(forward[i], options)) forward[i].best_index = -1;
    }
#pragma omp for schedule(static)
    for (size_t j = 0; j < second.size(); ++j) {
      backward[j] = FindNearestTwo(second[j], first, all_first).best_index;
    }
  }
  return KeepMutual(forward, backward);
}

std::vector<Match> MatchNearby(const Features& first, const Features& second, double radius,
                               const MatchOptions& options) {
  std::vector<NearestTwo> forward = FindNearby(first, second, radius, options.num_threads);
  for (NearestTwo& nearest : forward) {
    if (nearest.second_index >= 0 && second.keypoints[nearest.second_index].level !=
                                         second.keypoints[nearest.best_index].level) {
      nearest.second_distance = NearestTwo::kNone;
    }
    if (!IsDistinct(nearest, options)) nearest.best_index = -1;
  }
  std::vector<int> backward;
  for (const NearestTwo& nearest : FindNearby(second, first, radius, options.num_threads)) {
    backward.push_back(nearest.best_index);
  }
  return KeepMutual(forward, backward);
}

}  // namespace orb360
