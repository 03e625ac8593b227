#include "slam/scale/clock_offset_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>

#include "nn/base/statistics.h"

namespace orb360 {
namespace {

using Complex = std::complex<double>;

constexpr size_t kMaxCandidates = 8;
constexpr double kMinOverlap = 0.5;  // of the shorter one's duration
// Products of a place of the path and a fix: some seconds of work.
constexpr double kMaxProducts = 3e8;
constexpr double kMaxStep = 1.0;  // seconds: refinement of the offset starts within half of it
constexpr double kPathSteps = 60;
constexpr size_t kMinPairs = 6;

/// Places at steps of a fixed length in time, seen from above. Where none is known, `weight` is 0.
struct Grid {
  std::vector<Complex> place;
  std::vector<double> weight;
};

Grid Sample(std::span<const PathPoint> path, double begin, double step, size_t count,
            double max_gap) {
  Grid grid{std::vector<Complex>(count), std::vector<double>(count)};
  for (size_t i = 0; i < count; ++i) {
    const auto state = Interpolate(path, begin + step * static_cast<double>(i), max_gap);
    if (!state) continue;
    grid.place[i] = {state->position.x(), state->position.y()};
    grid.weight[i] = 1;
  }
  return grid;
}

/// Receivers write a fix at a fixed interval, or fewer where the path is straight.
double MaxGap(std::span<const PathPoint> fixes) {
  std::vector<double> gaps;
  for (size_t i = 1; i < fixes.size(); ++i) {
    gaps.push_back(fixes[i].timestamp - fixes[i - 1].timestamp);
  }
  return std::max(kMaxPathGap, 3 * Median(gaps));
}

/// How well the path, moved by `shift` steps, agrees with the fixes: the logarithm of the fraction
/// of the variance that no similarity explains, times the number of pairs. 0: not at all.
double Disagreement(const Grid& path, const Grid& fixes, std::int64_t shift, size_t min_pairs,
                    double noise_variance) {
  const auto begin = static_cast<size_t>(std::max<std::int64_t>(0, -shift));
  const auto last = static_cast<std::int64_t>(fixes.place.size()) - shift;
  const auto end = static_cast<size_t>(
      std::clamp<std::int64_t>(last, 0, static_cast<std::int64_t>(path.place.size())));
  double count = 0;
  Complex sum_p, sum_f, sum_pf;
  double sum_pp = 0, sum_ff = 0;
  for (size_t i = begin; i < end; ++i) {
    const auto k = static_cast<size_t>(static_cast<std::int64_t>(i) + shift);
    const double weight = path.weight[i] * fixes.weight[k];
    const Complex p = weight * path.place[i];
    const Complex f = weight * fixes.place[k];
    count += weight;
    sum_p += p;
    sum_f += f;
    sum_pp += std::norm(p);
    sum_ff += std::norm(f);
    sum_pf += std::conj(p) * f;
  }
  if (count < static_cast<double>(min_pairs)) return 0;
  const double variance_p = sum_pp - std::norm(sum_p) / count;
  const double variance_f = sum_ff - std::norm(sum_f) / count;
  const double covariance = std::norm(sum_pf - std::conj(sum_p) * sum_f / count);
  if (!(variance_p > 0 && variance_f > 0)) return 0;
  const double explained = covariance / (variance_p * variance_f);
  const double noise = 2 * count * noise_variance / variance_f;
  return count * std::log(std::min(1.0, 1 - std::min(1.0, explained) + noise));
}

}  // namespace

std::vector<double> FindClockOffsets(std::span<const PathPoint> path, const Positions& positions) {
  if (positions.clock_offset_sigma == 0) return {positions.clock_offset};
  if (path.size() < 2 || positions.fixes.size() < 2) return {};
  std::vector<PathPoint> fixes;
  std::vector<double> sigmas;
  // Coordinates are taken about the first place, so that squares keep their digits.
  for (const PositionFix& fix : positions.fixes) {
    fixes.push_back({fix.timestamp, fix.position - positions.fixes.front().position});
    sigmas.push_back(fix.sigma);
  }
  std::vector<PathPoint> centered(path.begin(), path.end());
  for (PathPoint& point : centered) point.position -= path.front().position;

  const double path_duration = path.back().timestamp - path.front().timestamp;
  const double fixes_duration = fixes.back().timestamp - fixes.front().timestamp;
  const double shorter = std::min(path_duration, fixes_duration);
  if (!(shorter > 0)) return {};
  const double step = std::max(std::min(kMaxStep, shorter / kPathSteps),
                               std::sqrt(path_duration * fixes_duration / kMaxProducts));
  const auto path_count = static_cast<size_t>(path_duration / step) + 1;
  const auto fixes_count = static_cast<size_t>(fixes_duration / step) + 1;
  const Grid path_grid = Sample(centered, path.front().timestamp, step, path_count, kMaxPathGap);
  const Grid fixes_grid = Sample(fixes, fixes.front().timestamp, step, fixes_count, MaxGap(fixes));

  // At a shift of k, place i of the path belongs to place i + k of the fixes.
  const double zero = path.front().timestamp - fixes.front().timestamp;
  const auto overlap = static_cast<std::int64_t>(kMinOverlap * shorter / step);
  std::int64_t first = overlap - static_cast<std::int64_t>(path_count);
  std::int64_t last = static_cast<std::int64_t>(fixes_count) - overlap;
  if (std::isfinite(positions.clock_offset_sigma)) {
    const double middle = (zero - positions.clock_offset) / step;
    const double width = 3 * positions.clock_offset_sigma / step;
    first = std::max(first, static_cast<std::int64_t>(std::floor(middle - width)));
    last = std::min(last, static_cast<std::int64_t>(std::ceil(middle + width)));
  }
  const double sigma = Median(sigmas);
  std::vector<double> costs;
  for (std::int64_t shift = first; shift <= last; ++shift) {
    const size_t min_pairs = std::max(kMinPairs, static_cast<size_t>(overlap) / 2);
    costs.push_back(Disagreement(path_grid, fixes_grid, shift, min_pairs, sigma * sigma));
  }
  std::vector<size_t> minima;
  for (size_t i = 0; i < costs.size(); ++i) {
    const bool is_minimum =
        (i == 0 || costs[i] <= costs[i - 1]) && (i + 1 == costs.size() || costs[i] < costs[i + 1]);
    if (costs[i] < 0 && is_minimum) minima.push_back(i);
  }
  std::ranges::stable_sort(minima, {}, [&](size_t i) { return costs[i]; });
  if (minima.size() > kMaxCandidates) minima.resize(kMaxCandidates);
  std::vector<double> offsets;
  for (const size_t i : minima) {
    offsets.push_back(zero - step * static_cast<double>(first + static_cast<std::int64_t>(i)));
  }
  return offsets;
}

}  // namespace orb360
