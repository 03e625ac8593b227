#include "slam/features/corner_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "slam/features/fast_score.h"

namespace orb360 {
namespace {

// Zones of latitude, as bands [begin, end), within which corners compete by strength alone: about
// 45 degrees wide at the poles, 22.5 elsewhere. In narrower ones the choice would hang on where
// their borders happen to lie.
struct Zone {
  int begin;
  int end;
};
constexpr std::array<Zone, 6> kZones = {{{0, 4}, {4, 6}, {6, 8}, {8, 10}, {10, 12}, {12, 16}}};

// Even shares that a band or a cell may contribute before weaker corners elsewhere come first. With
// one, corners would be spread most evenly, but the choice would hang on where the cells happen to
// lie: pitching a textured sphere by 45 degrees, 63 % of the features are found again with one, 72
// % with three, 74 % with four, and no more than 75 % without a limit.
constexpr double kMaxShares = 4.0;

// A local maximum as found, with its own and its neighbours' scores.
struct Maximum {
  int x;
  int y;
  uint8_t score, left, right, above, below;
};

// Strongest first; among equals the order within the cell, which no roll by whole cells changes.
bool IsStronger(const Maximum& a, const Maximum& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

// Offset in [-0.5, 0.5] of the maximum of the parabola through three scores, middle the largest.
double ParabolaPeak(int before, int middle, int after) {
  const int curvature = 2 * middle - before - after;
  return curvature == 0 ? 0.0 : std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

// The strongest `count`, those within their share first; equals at the cut are kept. Moves the
// rest to `spare`.
std::vector<Candidate> TakeStrongest(std::vector<Candidate> candidates, int count,
                                     std::vector<Candidate>* spare) {
  const auto preference = [](const Candidate& c) {
    return (c.within_share ? 256 : 0) + c.corner.score;
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

using Cells = std::array<std::vector<Maximum>, kSphereColumns>;

// All local maxima of a band, by cell.
Cells FindMaxima(const PyramidLevel& level, const SphereBand& band, uint8_t min_score,
                 const cv::Mat& mask) {
  const int width = band.width;
  // Three rows of scores with one column beyond either side, for the 3x3 maximum, turned as the
  // window moves down.
  constexpr int kPad = 1;
  cv::Mat scores = cv::Mat::zeros(3, width + 2 * kPad, CV_8U);
  const auto score_row = [&](int y) { return scores.ptr((y + 3) % 3) + kPad; };
  const auto compute = [&](int y) {
    uint8_t* row = score_row(y);
    FastScoreRow(band.Pixel(0, y), band.stride(), width, min_score, row);
    row[-1] = row[width - 1];
    row[width] = row[0];
  };
  Cells cells;
  std::vector<int> columns;
  compute(band.y_begin - 1);
  compute(band.y_begin);
  for (int y = band.y_begin; y < band.y_end; ++y) {
    compute(y + 1);
    columns.clear();
    const uint8_t* above = score_row(y - 1);
    const uint8_t* middle = score_row(y);
    const uint8_t* below = score_row(y + 1);
    FastMaximaRow(above, middle, below, width, min_score, &columns);
    const uint8_t* mask_row =
        mask.empty() ? nullptr : mask.ptr(y * mask.rows / level.camera.height());
    for (const int x : columns) {
      if (mask_row != nullptr && mask_row[(int64_t{2} * x + 1) * mask.cols / (2 * width)] == 0) {
        continue;
      }
      cells[x * kSphereColumns / width].push_back(
          {x, y, middle[x], middle[x - 1], middle[x + 1], above[x], below[x]});
    }
  }
  return cells;
}

// Sub-pixel position on the level. Counted from the edge of the cell, a dyadic number, so that
// rounding is the same in all cells.
Corner PlaceOnLevel(const Maximum& m, int cell, int index, int band_width, int level_width) {
  const double scale = static_cast<double>(level_width) / band_width;
  const double from_edge = m.x + 0.5 - static_cast<double>(cell) * band_width / kSphereColumns;
  const double edge = static_cast<double>(cell) * level_width / kSphereColumns;
  return {index,
          m.x,
          m.y,
          m.score,
          edge + (from_edge + ParabolaPeak(m.left, m.score, m.right)) * scale,
          m.y + 0.5 + ParabolaPeak(m.above, m.score, m.below)};
}

// Takes the mark from all that are weaker than the `share` strongest with it.
void LimitBand(int share, std::vector<Candidate>* candidates) {
  std::vector<uint8_t> scores;
  for (const Candidate& c : *candidates) {
    if (c.within_share) scores.push_back(c.corner.score);
  }
  if (static_cast<int>(scores.size()) <= share) return;
  const auto weakest = scores.begin() + std::max(0, share - 1);
  std::nth_element(scores.begin(), weakest, scores.end(), std::greater<>());
  for (Candidate& c : *candidates) c.within_share &= c.corner.score >= *weakest;
}

// Half the difference of the sines of the latitudes at two rows: the share of the sphere's solid
// angle between them.
double ShareOfSphere(int height, int y_begin, int y_end) {
  const auto sine = [&](int y) { return std::cos(std::numbers::pi * y / height); };
  return 0.5 * (sine(y_begin) - sine(y_end));
}

}  // namespace

BandCorners FindInBand(const PyramidLevel& level, const SphereBand& band, int index, int count,
                       uint8_t min_score, const cv::Mat& mask) {
  const double share = ShareOfSphere(level.camera.height(), band.y_begin, band.y_end);
  const int per_cell = static_cast<int>(std::ceil(kMaxShares * share * count / kSphereColumns));
  // More than a few times its share no cell will ever be asked for.
  const size_t max_per_cell = 2 * (per_cell + 1);
  BandCorners found{share, {}};
  Cells cells = FindMaxima(level, band, min_score, mask);
  for (int c = 0; c < kSphereColumns; ++c) {
    std::vector<Maximum>& cell = cells[c];
    const size_t kept = std::min(cell.size(), max_per_cell);
    std::partial_sort(cell.begin(), cell.begin() + kept, cell.end(), IsStronger);
    for (size_t i = 0; i < kept; ++i) {
      found.candidates.push_back({PlaceOnLevel(cell[i], c, index, band.width, level.camera.width()),
                                  static_cast<int>(i) < per_cell});
    }
  }
  LimitBand(static_cast<int>(std::ceil(kMaxShares * share * count)), &found.candidates);
  return found;
}

std::vector<Corner> SelectCorners(std::span<const BandCorners> bands, int count) {
  std::vector<Candidate> chosen;
  std::vector<Candidate> spare;
  const auto take = [&](std::vector<Candidate> candidates, int number) {
    std::vector<Candidate> rest;
    const std::vector<Candidate> taken = TakeStrongest(std::move(candidates), number, &rest);
    chosen.insert(chosen.end(), taken.begin(), taken.end());
    spare.insert(spare.end(), rest.begin(), rest.end());
  };
  for (const Zone& zone : kZones) {
    std::vector<Candidate> candidates;
    double share = 0;
    for (int band = zone.begin; band < zone.end; ++band) {
      candidates.insert(candidates.end(), bands[band].candidates.begin(),
                        bands[band].candidates.end());
      share += bands[band].share;
    }
    take(std::move(candidates), static_cast<int>(std::lround(share * count)));
  }
  const int lacking = count - static_cast<int>(chosen.size());
  if (lacking > 0) take(std::exchange(spare, {}), lacking);
  std::vector<Corner> corners;
  corners.reserve(chosen.size());
  for (const Candidate& candidate : chosen) corners.push_back(candidate.corner);
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.u < b.u; });
  return corners;
}

}  // namespace orb360
