#pragma once

#include <cstdint>
#include <vector>

namespace orb360 {

/// Where each sample of a resampled row or column lies between two of its source, pixel centre to
/// pixel centre. Computed in exact rational arithmetic: with both sizes divisible by 32 the taps
/// repeat exactly 32 times around a panorama.
struct ResampleTaps {
  static constexpr int kWeightBits = 7;
  static constexpr int kWeightOne = 1 << kWeightBits;

  ResampleTaps(int source, int target);

  int size() const { return static_cast<int>(index.size()); }

  int source_size;
  std::vector<int32_t> index;    // of the first of the two samples; -1 where it lies before the row
  std::vector<uint16_t> weight;  // of the second, in 1/kWeightOne
  /// Both samples' places after index[i - i % 8], for 8 pixels at a time; empty where these lie
  /// more than 16 samples apart.
  std::vector<uint8_t> lookup;
};

/// blended[x] = ((kWeightOne - weight) * upper[x] + weight * lower[x]) / kWeightOne, rounded to
/// nearest, for `count` pixels.
void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count, uint8_t* blended);

/// taps.size() pixels of `row`, rounded to nearest; `out` may be `row` where it shrinks. Reads
/// row[-1] where the first index is -1, and up to kResampleReach pixels beyond the last index,
/// whose values do not matter but for the first.
inline constexpr int kResampleReach = 15;
void ResampleRow(const uint8_t* row, const ResampleTaps& taps, uint8_t* out);

/// Means of 2x2 pixels, rounded: `count` of them from two rows of twice as many.
void HalveRows(const uint8_t* upper, const uint8_t* lower, int count, uint8_t* out);

}  // namespace orb360
