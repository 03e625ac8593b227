#pragma once

#include <cstdint>
#include <vector>

namespace orb360 {

/// Position of each sample of a resampled row or column between two samples of its source, from
/// pixel centre to pixel centre. It is computed in exact rational arithmetic: if both sizes are
/// divisible by 32, the taps repeat exactly 32 times around a panorama.
struct ResampleTaps {
  static constexpr int kWeightBits = 7;
  static constexpr int kWeightOne = 1 << kWeightBits;

  ResampleTaps(int source, int target);

  int size() const { return static_cast<int>(index.size()); }

  int source_size;
  std::vector<int32_t> index;    // of the first of the two samples; -1 where it lies before the row
  std::vector<uint16_t> weight;  // of the second, in 1/kWeightOne
  /// Offsets of both samples from index[i - i % 8], for 8 pixels at a time; empty where they are
  /// more than 16 samples apart.
  std::vector<uint8_t> lookup;
};

/// blended[x] = ((kWeightOne - weight) * upper[x] + weight * lower[x]) / kWeightOne, rounded to
/// nearest, for `count` pixels.
void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count, uint8_t* blended);

/// Computes taps.size() pixels of `row`, rounded to nearest; `out` may be `row` if the row shrinks.
/// Reads row[-1] if the first index is -1, and up to kResampleReach pixels beyond the last index,
/// of which only the first one affects the result.
inline constexpr int kResampleReach = 15;
void ResampleRow(const uint8_t* row, const ResampleTaps& taps, uint8_t* out);

/// Computes `count` means of 2x2 pixels, rounded, from two rows of twice as many pixels.
void HalveRows(const uint8_t* upper, const uint8_t* lower, int count, uint8_t* out);

}  // namespace orb360
