#include "slam/features/corner_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "slam/features/fast_score.h"

namespace orb360 {
namespace {

// Bands of 11.25 degrees: cells near the equator are then about square.
constexpr int kBands = 16;
// Rows of the score map continue the sphere by this much on both sides, for the 3x3 maximum.
constexpr int kScoreMargin = 1;

struct Candidate {
  Corner corner;
  int column;  // 0..31, the cell in its band
  int rank;    // within the cell, 0 = strongest
};

// Strongest first; among equals the order within the cell, which no roll by whole cells changes.
bool StrongerInCell(const Candidate& a, const Candidate& b) {
  if (a.corner.score != b.corner.score) return a.corner.score > b.corner.score;
  if (a.corner.y != b.corner.y) return a.corner.y < b.corner.y;
  return a.corner.x < b.corner.x;
}

// Offset in [-0.5, 0.5] of the maximum of the parabola through three scores, middle the largest.
float ParabolaPeak(int before, int middle, int after) {
  const int curvature = 2 * middle - before - after;
  return curvature == 0 ? 0.0f : std::clamp(0.5f * (after - before) / curvature, -0.5f, 0.5f);
}

// The strongest `count` by (rank in the cell < cap first, then score); equals at the cut are kept.
// Moves the rest, in the same preference, to `spare`.
std::vector<Candidate> TakeStrongest(std::vector<Candidate> candidates, int count, int cap,
                                     std::vector<Candidate>* spare) {
  const auto preference = [cap](const Candidate& c) {
    return (c.rank < cap ? 256 : 0) + c.corner.score;
  };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const auto& a, const auto& b) { return preference(a) > preference(b); });
  size_t kept = std::min<size_t>(count, candidates.size());
  while (kept > 0 && kept < candidates.size() &&
         preference(candidates[kept]) == preference(candidates[kept - 1])) {
    ++kept;
  }
  spare->insert(spare->end(), candidates.begin() + kept, candidates.end());
  candidates.resize(kept);
  return candidates;
}

// All local maxima of rows [y_begin, y_end).
std::vector<Candidate> FindCandidates(const PyramidLevel& level, int y_begin, int y_end,
                                      uint8_t min_score, const cv::Mat& mask) {
  const int width = level.camera.width();
  const int height = level.camera.height();
  const cv::Mat image = level.image();
  const ptrdiff_t stride = static_cast<ptrdiff_t>(image.step);
  // Three rows of scores, one column of margin either side, turned as the window moves down.
  // kPad keeps vector loads at the row's end inside the buffer.
  constexpr int kPad = 8;
  cv::Mat scores = cv::Mat::zeros(3, width + 2 * kPad, CV_8U);
  const auto score_row = [&](int y) { return scores.ptr((y + 3) % 3) + kPad; };
  const auto compute = [&](int y) {
    uint8_t* row = score_row(y);
    // The circle reaches 3 rows beyond; margins of the level hold the sphere's continuation.
    FastScoreRow(image.ptr(0) + y * stride, stride, width, min_score, row);
    row[-kScoreMargin] = row[width - 1];
    row[width] = row[0];
  };
  std::vector<Candidate> candidates;
  std::vector<int> columns;
  compute(y_begin - 1);
  compute(y_begin);
  for (int y = y_begin; y < y_end; ++y) {
    compute(y + 1);
    columns.clear();
    const uint8_t* above = score_row(y - 1);
    const uint8_t* middle = score_row(y);
    const uint8_t* below = score_row(y + 1);
    FastMaximaRow(above, middle, below, width, min_score, &columns);
    const uint8_t* mask_row = mask.empty() ? nullptr : mask.ptr(y * mask.rows / height);
    for (const int x : columns) {
      if (mask_row != nullptr && mask_row[static_cast<int64_t>(x) * mask.cols / width] == 0) {
        continue;
      }
      const Corner corner{x, y, middle[x], ParabolaPeak(middle[x - 1], middle[x], middle[x + 1]),
                          ParabolaPeak(above[x], middle[x], below[x])};
      candidates.push_back({corner, x * kSphereColumns / width, 0});
    }
  }
  return candidates;
}

// Orders candidates by cell and strength, keeping at most `max_per_cell`, and sets their ranks.
void RankInCells(int max_per_cell, std::vector<Candidate>* candidates) {
  std::array<std::vector<Candidate>, kSphereColumns> cells;
  for (const Candidate& candidate : *candidates) cells[candidate.column].push_back(candidate);
  candidates->clear();
  for (std::vector<Candidate>& cell : cells) {
    if (static_cast<int>(cell.size()) > max_per_cell) {
      std::nth_element(cell.begin(), cell.begin() + max_per_cell, cell.end(), StrongerInCell);
      cell.resize(max_per_cell);
    }
    std::sort(cell.begin(), cell.end(), StrongerInCell);
    for (size_t i = 0; i < cell.size(); ++i) cell[i].rank = static_cast<int>(i);
    candidates->insert(candidates->end(), cell.begin(), cell.end());
  }
}

struct Band {
  std::vector<Candidate> chosen;
  std::vector<Candidate> spare;
};

// The share of one band of latitude.
Band SelectInBand(const PyramidLevel& level, int band, int count, uint8_t min_score,
                  const cv::Mat& mask) {
  const int height = level.camera.height();
  const int y_begin = band * height / kBands;
  const int y_end = (band + 1) * height / kBands;
  std::vector<Candidate> candidates = FindCandidates(level, y_begin, y_end, min_score, mask);
  // Solid angle of a band over the sphere's: half the difference of the latitudes' sines.
  const auto sine = [&](int y) { return std::cos(std::numbers::pi * y / height); };
  const double quota = count * 0.5 * (sine(y_begin) - sine(y_end));
  const int cap = static_cast<int>(std::ceil(quota / kSphereColumns));
  // More than a few times its share no cell will ever be asked for.
  RankInCells(4 * (cap + 1), &candidates);
  Band result;
  result.chosen = TakeStrongest(std::move(candidates), static_cast<int>(std::lround(quota)), cap,
                                &result.spare);
  return result;
}

// All bands of a level, filled up to `count` with what is spare.
std::vector<Corner> Combine(std::span<const Band> bands, int count) {
  std::vector<Candidate> all;
  std::vector<Candidate> rest;
  for (const Band& band : bands) {
    all.insert(all.end(), band.chosen.begin(), band.chosen.end());
    rest.insert(rest.end(), band.spare.begin(), band.spare.end());
  }
  if (static_cast<int>(all.size()) < count) {
    std::vector<Candidate> unused;
    // Twice the even share of a cell, so that what is added is spread as well.
    const int cap = 2 + 2 * count / (kBands * kSphereColumns);
    const std::vector<Candidate> more =
        TakeStrongest(std::move(rest), count - static_cast<int>(all.size()), cap, &unused);
    all.insert(all.end(), more.begin(), more.end());
  }
  std::vector<Corner> corners;
  corners.reserve(all.size());
  for (const Candidate& candidate : all) corners.push_back(candidate.corner);
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return corners;
}

}  // namespace

std::vector<std::vector<Corner>> SelectCorners(const std::vector<PyramidLevel>& levels,
                                               const std::vector<int>& counts, uint8_t min_score,
                                               const cv::Mat& mask) {
  const int num_bands = static_cast<int>(levels.size()) * kBands;
  std::vector<Band> bands(num_bands);
  std::vector<std::vector<Corner>> corners(levels.size());
#pragma omp parallel
  {
#pragma omp for schedule(dynamic)
    for (int i = 0; i < num_bands; ++i) {
      const int level = i / kBands;
      bands[i] = SelectInBand(levels[level], i % kBands, counts[level], min_score, mask);
    }
#pragma omp for schedule(dynamic)
    for (size_t level = 0; level < levels.size(); ++level) {
      corners[level] =
          Combine(std::span<const Band>(bands).subspan(level * kBands, kBands), counts[level]);
    }
  }
  return corners;
}

}  // namespace orb360
