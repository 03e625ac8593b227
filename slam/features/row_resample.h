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

  ResampleTaps(int source_size, int target_size);

  std::vector<int32_t> index;   // of the first of the two samples; -1 where it lies before the row
  std::vector<int32_t> weight;  // of the second, in 1/kWeightOne
};

/// blended[x] = (kWeightOne - weight) * upper[x] + weight * lower[x], for `count` pixels.
void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count,
               uint16_t* blended);

/// Row of taps.index.size() pixels from a blended one; reads blended[-1] where the first index is
/// -1, and one element beyond the last index. Rounds to nearest.
void ResampleRow(const uint16_t* blended, const ResampleTaps& taps, uint8_t* out);

/// Means of 2x2 pixels, rounded: `count` of them from two rows of twice as many.
void HalveRows(const uint8_t* upper, const uint8_t* lower, int count, uint8_t* out);

}  // namespace orb360
