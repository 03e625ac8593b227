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
// Steps of the offset, seconds: its refinement starts within half of one.
constexpr double kFinestStep = 1.0;
// Coarser ones would have to search tracks of days, and take gigabytes for years.
constexpr double kCoarsestStep = 4.0;
constexpr double kMaxInnerGap = 3600;  // seconds
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
  if (fixes.size() < 2) return kMaxPathGap;
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

/// An offset that may be right; the more negative the cost, the better.
struct ScoredOffset {
  double offset;
  double cost;
};

/// The fixes that can lie on the path by what is known of the offset, and one on either side.
std::span<const PathPoint> NearPath(std::span<const PathPoint> fixes,
                                    std::span<const PathPoint> path, const Positions& positions) {
  if (!std::isfinite(positions.clock_offset_sigma)) return fixes;
  const double margin = 3 * positions.clock_offset_sigma;
  const double begin = path.front().timestamp - positions.clock_offset - margin;
  const double end = path.back().timestamp - positions.clock_offset + margin;
  auto first = std::ranges::lower_bound(fixes, begin, {}, &PathPoint::timestamp);
  auto last = std::ranges::upper_bound(fixes, end, {}, &PathPoint::timestamp);
  if (first != fixes.begin()) --first;
  if (last != fixes.end()) ++last;
  return {first, last};
}

/// Splits fixes at gaps, in which nothing has to be searched.
std::vector<std::span<const PathPoint>> SplitAtGaps(std::span<const PathPoint> fixes) {
  const double max_gap = std::max(kMaxInnerGap, MaxGap(fixes));
  std::vector<std::span<const PathPoint>> pieces;
  size_t begin = 0;
  for (size_t i = 1; i <= fixes.size(); ++i) {
    if (i < fixes.size() && fixes[i].timestamp - fixes[i - 1].timestamp <= max_gap) continue;
    if (i - begin >= kMinPairs) pieces.push_back(fixes.subspan(begin, i - begin));
    begin = i;
  }
  return pieces;
}

/// Appends the local minima of the cost over all offsets at which fixes without a large gap overlap
/// the path.
void SearchPiece(std::span<const PathPoint> path, std::span<const PathPoint> fixes,
                 const Positions& positions, double sigma, std::vector<ScoredOffset>* found) {
  const double path_duration = path.back().timestamp - path.front().timestamp;
  const double fixes_duration = fixes.back().timestamp - fixes.front().timestamp;
  const double shorter = std::min(path_duration, fixes_duration);
  if (!(shorter > 0)) return;
  const double step = std::max(std::min(kFinestStep, shorter / kPathSteps),
                               std::sqrt(path_duration * fixes_duration / kMaxProducts));
  if (step > kCoarsestStep) return;
  const auto path_count = static_cast<size_t>(path_duration / step) + 1;
  const auto fixes_count = static_cast<size_t>(fixes_duration / step) + 1;
  const Grid path_grid = Sample(path, path.front().timestamp, step, path_count, kMaxPathGap);
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
  std::vector<double> costs;
  for (std::int64_t shift = first; shift <= last; ++shift) {
    const size_t min_pairs = std::max(kMinPairs, static_cast<size_t>(overlap) / 2);
    costs.push_back(Disagreement(path_grid, fixes_grid, shift, min_pairs, sigma * sigma));
  }
  for (size_t i = 0; i < costs.size(); ++i) {
    const bool is_minimum =
        (i == 0 || costs[i] <= costs[i - 1]) && (i + 1 == costs.size() || costs[i] < costs[i + 1]);
    if (!(costs[i] < 0 && is_minimum)) continue;
    found->push_back(
        {zero - step * static_cast<double>(first + static_cast<std::int64_t>(i)), costs[i]});
  }
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
  const double sigma = Median(sigmas);
  const std::span<const PathPoint> near = NearPath(fixes, centered, positions);
  std::vector<ScoredOffset> found;
  for (const std::span<const PathPoint> piece : SplitAtGaps(near)) {
    SearchPiece(centered, piece, positions, sigma, &found);
  }
  std::ranges::stable_sort(found, {}, &ScoredOffset::cost);
  if (found.size() > kMaxCandidates) found.resize(kMaxCandidates);
  std::vector<double> offsets;
  for (const ScoredOffset& candidate : found) offsets.push_back(candidate.offset);
  return offsets;
}

}  // namespace orb360
