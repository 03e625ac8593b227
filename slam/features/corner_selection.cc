#include "slam/features/corner_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "slam/features/fast_score.h"

namespace orb360 {
namespace {

// Zones of latitude, as bands [begin, end), within which corners compete by strength alone. They
// are about 45 degrees wide at the poles and 22.5 degrees elsewhere. In narrower zones the choice
// would depend on the position of their borders.
struct Zone {
  int begin;
  int end;
};
constexpr std::array<Zone, 6> kZones = {{{0, 4}, {4, 6}, {6, 8}, {8, 10}, {10, 12}, {12, 16}}};

// Multiple of its even quota that a band or a cell may contribute before weaker corners elsewhere
// are preferred. With 1 the corners would be distributed most evenly, but the choice would depend
// on the position of the cells. When a textured sphere is pitched by 45 degrees, 63 % of the
// features are found again with 1, 72 % with 3, 74 % with 4, and at most 75 % without a limit.
constexpr double kMaxQuotas = 4.0;

// Orders by strength, then by the position within the cell, which a roll by whole cells does not
// change.
bool IsStronger(const Maximum& a, const Maximum& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

// Returns all local maxima of a band, ordered by row and column.
std::vector<Maximum> Scan(const PyramidLevel& level, const SphereBand& band, uint8_t min_score,
                          const cv::Mat& mask) {
  const int width = band.width;
  // Three rows of scores for the 3x3 maximum, with one further column on either side. They are used
  // cyclically as the window moves down.
  constexpr int kPad = 1;
  cv::Mat scores = cv::Mat::zeros(3, width + 2 * kPad, CV_8U);
  const auto score_row = [&](int y) { return scores.ptr((y + 3) % 3) + kPad; };
  const auto compute = [&](int y) {
    uint8_t* row = score_row(y);
    FastScoreRow(band.Pixel(0, y), band.stride(), width, min_score, row);
    row[-1] = row[width - 1];
    row[width] = row[0];
  };
  std::vector<Maximum> maxima;
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
      maxima.push_back({x, y, middle[x], middle[x - 1], middle[x + 1], above[x], below[x],
                        static_cast<uint8_t>(x * kSphereColumns / width), false});
    }
  }
  return maxima;
}

// Returns the strongest `max_per_cell` maxima of each cell; the first `quota` of them are marked.
std::vector<Maximum> LimitCells(const std::vector<Maximum>& maxima, size_t max_per_cell,
                                size_t quota) {
  std::array<size_t, kSphereColumns + 1> begin = {};
  for (const Maximum& m : maxima) ++begin[m.cell + 1];
  for (int c = 0; c < kSphereColumns; ++c) begin[c + 1] += begin[c];
  std::array<size_t, kSphereColumns + 1> next = begin;
  std::vector<Maximum> sorted(maxima.size());
  for (const Maximum& m : maxima) sorted[next[m.cell]++] = m;
  std::vector<Maximum> kept;
  for (int c = 0; c < kSphereColumns; ++c) {
    const std::span<Maximum> cell(sorted.data() + begin[c], begin[c + 1] - begin[c]);
    const size_t count = std::min(cell.size(), max_per_cell);
    std::partial_sort(cell.begin(), cell.begin() + count, cell.end(), IsStronger);
    for (size_t i = 0; i < count; ++i) {
      cell[i].within_quota = i < quota;
      kept.push_back(cell[i]);
    }
  }
  return kept;
}

// Unmarks all maxima that are weaker than the `quota` strongest marked ones.
void LimitBand(int quota, std::vector<Maximum>* maxima) {
  std::array<int, 256> histogram = {};
  for (const Maximum& m : *maxima) histogram[m.score] += m.within_quota;
  int weakest = 255;
  for (int sum = histogram[weakest]; sum < quota && weakest > 0;) sum += histogram[--weakest];
  for (Maximum& m : *maxima) m.within_quota &= m.score >= weakest;
}

// Fraction of the sphere's solid angle between two rows: half the difference of the sines of their
// latitudes.
double FractionOfSphere(int height, int y_begin, int y_end) {
  const auto sine = [&](int y) { return std::cos(std::numbers::pi * y / height); };
  return 0.5 * (sine(y_begin) - sine(y_end));
}

struct Candidate {
  int band;
  Maximum maximum;
};

// Moves about the strongest `count` corners from `candidates` to `taken`, marked ones first. All
// corners of equal strength at the cut are taken. The order of both lists is kept.
void TakeStrongest(int count, std::vector<Candidate>* candidates, std::vector<Candidate>* taken) {
  if (count <= 0) return;
  const auto preference = [](const Candidate& c) {
    return (c.maximum.within_quota ? 256 : 0) + c.maximum.score;
  };
  std::array<int, 512> histogram = {};
  for (const Candidate& c : *candidates) ++histogram[preference(c)];
  int cut = 511;
  for (int sum = histogram[cut]; sum < count && cut > 0;) sum += histogram[--cut];
  std::erase_if(*candidates, [&](const Candidate& c) {
    if (preference(c) < cut) return false;
    taken->push_back(c);
    return true;
  });
}

// Returns the offset in [-0.5, 0.5] of the maximum of the parabola through three scores, of which
// the middle one is the largest.
double ParabolaPeak(int before, int middle, int after) {
  const int curvature = 2 * middle - before - after;
  return curvature == 0 ? 0.0 : std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

// Sub-pixel position on the level. It is counted from the edge of the cell, a dyadic number, so
// that rounding is the same in all cells.
Corner PlaceOnLevel(const Maximum& m, int band, int band_width, int level_width) {
  const double scale = static_cast<double>(level_width) / band_width;
  const double from_edge = m.x + 0.5 - static_cast<double>(m.cell) * band_width / kSphereColumns;
  const double edge = static_cast<double>(m.cell) * level_width / kSphereColumns;
  return {band,
          m.x,
          m.y,
          m.score,
          edge + (from_edge + ParabolaPeak(m.left, m.score, m.right)) * scale,
          m.y + 0.5 + ParabolaPeak(m.above, m.score, m.below)};
}

}  // namespace

BandMaxima FindMaxima(const PyramidLevel& level, const SphereBand& band, int count,
                      uint8_t min_score, const cv::Mat& mask) {
  const double fraction = FractionOfSphere(level.camera.height(), band.y_begin, band.y_end);
  const int per_band = static_cast<int>(std::ceil(kMaxQuotas * fraction * count));
  const int per_cell = (per_band + kSphereColumns - 1) / kSphereColumns;
  // No cell is asked for more than a few times its quota.
  std::vector<Maximum> maxima =
      LimitCells(Scan(level, band, min_score, mask), 2 * (per_cell + 1), per_cell);
  LimitBand(per_band, &maxima);
  return {band.width, fraction, std::move(maxima)};
}

std::vector<Corner> SelectCorners(std::span<const BandMaxima> bands, int level_width, int count) {
  std::vector<Candidate> taken;
  std::vector<Candidate> spare;
  std::vector<Candidate> candidates;
  for (const Zone& zone : kZones) {
    candidates.clear();
    double fraction = 0;
    for (int band = zone.begin; band < zone.end; ++band) {
      for (const Maximum& m : bands[band].maxima) candidates.push_back({band, m});
      fraction += bands[band].fraction;
    }
    TakeStrongest(static_cast<int>(std::lround(fraction * count)), &candidates, &taken);
    spare.insert(spare.end(), candidates.begin(), candidates.end());
  }
  TakeStrongest(count - static_cast<int>(taken.size()), &spare, &taken);
  std::vector<Corner> corners;
  corners.reserve(taken.size());
  for (const Candidate& c : taken) {
    corners.push_back(PlaceOnLevel(c.maximum, c.band, bands[c.band].width, level_width));
  }
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.u < b.u; });
  return corners;
}

}  // namespace orb360
