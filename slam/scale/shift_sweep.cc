#include "slam/scale/shift_sweep.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orb360 {
namespace {

// Number of tiles straight below the point half-way.
constexpr int kTilesBelow = 4;
// Shifts of the first sweep below this many cells belong to a camera that hardly moves.
constexpr int kStill = 3;
// Where the tiles straight below correlate that well at a shift that is larger by this factor, and
// better by the lead than at the shift of the rest, the camera is above a dam, a bridge or a
// terrace: its height is that over the ground straight below, and the rest lies lower. On the
// recordings of docs/results/scale.md without a dam, no pair of images one frame apart passes.
constexpr float kMinBelow = 0.5f;
constexpr float kBelowLead = 0.15f;
constexpr double kMinElevation = 1.15;
/// Mean product of a square of both views.
template <int kSide>
float Correlate(const BirdsEyeView& view1, int along1, int across1, const BirdsEyeView& view2,
                int along2, int across2) {
  // Sums by column, so that the loop is vectorized in a fixed order.
  float sums[kSide] = {};
  for (int row = 0; row < kSide; ++row) {
    const float* a = view1.At(along1 + row, across1);
    const float* b = view2.At(along2 + row, across2);
    for (int i = 0; i < kSide; ++i) sums[i] += a[i] * b[i];
  }
  float sum = 0;
  for (const float value : sums) sum += value;
  return sum / (kSide * kSide);
}

/// The correlation of a tile, kSide cells on each side.
template <int kSide>
float CorrelateSquare(const BirdsEyeView& view1, const BirdsEyeView& view2, int tile,
                      const Shift& shift) {
  const int along = (tile / kTilesAcross - kTilesAlong / 2) * kSide;
  const int across = (tile % kTilesAcross - kTilesAcross / 2) * kSide;
  const auto half = [](int s) { return s >> 1; };  // rounded down
  return Correlate<kSide>(view1, along + shift.along - half(shift.along),
                          across + shift.across - half(shift.across), view2,
                          along - half(shift.along), across - half(shift.across));
}

/// Whether a tile is one of the four straight below the point half-way.
bool IsBelow(int tile) {
  const int along = tile / kTilesAcross - kTilesAlong / 2;
  const int across = tile % kTilesAcross - kTilesAcross / 2;
  return (along == -1 || along == 0) && (across == -1 || across == 0);
}

/// Mean correlations of all tiles and of those straight below.
struct TileCorrelation {
  float all = 0;
  float below = 0;
};

template <int kSide>
TileCorrelation MeanCorrelation(const BirdsEyeView& view1, const BirdsEyeView& view2,
                                const Shift& shift) {
  TileCorrelation sum;
  for (int tile = 0; tile < kTilesAlong * kTilesAcross; ++tile) {
    const float value = CorrelateSquare<kSide>(view1, view2, tile, shift);
    sum.all += value;
    if (IsBelow(tile)) sum.below += value;
  }
  return {sum.all / (kTilesAlong * kTilesAcross), sum.below / kTilesBelow};
}

/// A shift at which the views correlate best, of a sweep.
struct SweepPeak {
  Shift shift;  // cells of the coarse views
  double correlation;
  double rival;    // the largest of the other maxima
  bool is_inside;  // not at the end of the sweep
};

/// How well each shift along the motion correlates, with the best shift across it.
struct ShiftProfile {
  std::vector<Shift> shifts;
  std::vector<float> values;

  void Add(const Shift& shift, float value) {
    if (shifts.empty() || shifts.back().along != shift.along) {
      shifts.push_back(shift);
      values.push_back(value);
    } else if (value > values.back()) {
      shifts.back() = shift;
      values.back() = value;
    }
  }
  SweepPeak Peak(int aside) const {
    const size_t top = std::ranges::max_element(values) - values.begin();
    SweepPeak peak{
        .shift = shifts[top],
        .correlation = values[top],
        .rival = 0,
        .is_inside = top > 0 && top + 1 < values.size() && std::abs(shifts[top].across) < aside};
    for (size_t i = 1; i + 1 < values.size(); ++i) {
      if (i == top || values[i] < values[i - 1] || values[i] < values[i + 1]) continue;
      peak.rival = std::max<double>(peak.rival, values[i]);
    }
    return peak;
  }
};

struct SweepPeaks {
  SweepPeak all;    // of all tiles
  SweepPeak below;  // of those straight below
  float still;      // largest correlation of all tiles at shifts that are too short to be measured
};

/// Sweeps both shifts over the whole range.
SweepPeaks SweepCoarsely(const BirdsEyeView& view1, const BirdsEyeView& view2,
                         const GroundSweepOptions& options) {
  constexpr int kSide = kTile / kCoarse;
  const int aside = LargestAside(options) / kCoarse;
  const int first = std::max(1, static_cast<int>(options.min_ratio / (kCoarse * kCell)));
  const int last = static_cast<int>(options.max_ratio / (kCoarse * kCell));
  ShiftProfile all;
  ShiftProfile below;
  float still = -1;
  const auto sweep = [&](int from, int to, auto&& use) {
    for (int along = from; along <= to; ++along) {
      for (int across = -aside; across <= aside; ++across) {
        const Shift shift{along, across};
        use(shift, MeanCorrelation<kSide>(view1, view2, shift));
      }
    }
  };
  sweep(0, std::min(kStill, first) - 1,
        [&](const Shift&, const TileCorrelation& value) { still = std::max(still, value.all); });
  sweep(first, last, [&](const Shift& shift, const TileCorrelation& value) {
    all.Add(shift, value.all);
    below.Add(shift, value.below);
  });
  return {all.Peak(aside), below.Peak(aside), still};
}

/// The best shift around that of a first sweep, cells, and its correlation: that of all tiles, or
/// where `is_below`, of those straight below.
struct FineShift {
  Shift shift;
  float correlation;
};
FineShift SearchAround(const Shift& coarse, bool is_below, const BirdsEyeView& view1,
                       const BirdsEyeView& view2) {
  FineShift best{.shift = {}, .correlation = -1};
  for (int i = -kFineReach; i <= kFineReach; ++i) {
    for (int j = -kFineReach; j <= kFineReach; ++j) {
      const Shift shift{kCoarse * coarse.along + i, kCoarse * coarse.across + j};
      const TileCorrelation values = MeanCorrelation<kTile>(view1, view2, shift);
      const float value = is_below ? values.below : values.all;
      if (value > best.correlation) best = {shift, value};
    }
  }
  return best;
}

/// Whether the ground straight below lies higher than the rest.
bool IsHigherBelow(const SweepPeaks& peaks, const BirdsEyeView& view1, const BirdsEyeView& view2) {
  if (!(peaks.below.shift.along > kMinElevation * peaks.all.shift.along) ||
      !(peaks.below.correlation > kMinBelow)) {
    return false;
  }
  // Textures that repeat correlate at both shifts, if these are exact enough.
  return SearchAround(peaks.below.shift, true, view1, view2).correlation >
         SearchAround(peaks.all.shift, true, view1, view2).correlation + kBelowLead;
}

}  // namespace

float CorrelateTile(const BirdsEyeView& view1, const BirdsEyeView& view2, int tile,
                    const Shift& shift) {
  return CorrelateSquare<kTile>(view1, view2, tile, shift);
}

SweptShift SweepShift(const BirdsEyeView& view1, const BirdsEyeView& view2,
                      const BirdsEyeView& coarse1, const BirdsEyeView& coarse2,
                      const GroundSweepOptions& options) {
  const SweepPeaks peaks = SweepCoarsely(coarse1, coarse2, options);
  // A camera that hardly moves sees the same ground again at each period of a texture.
  if (peaks.still > peaks.all.correlation) return {};
  const bool is_below = IsHigherBelow(peaks, view1, view2);
  const SweepPeak& peak = is_below ? peaks.below : peaks.all;
  return {.shift = SearchAround(peak.shift, is_below, view1, view2).shift,
          .correlation = peak.correlation,
          .rival = peak.rival,
          .is_below = is_below,
          .is_peak = peak.is_inside};
}

}  // namespace orb360
