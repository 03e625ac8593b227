#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace orb360 {

/// FAST-9 corner score of `width` neighbouring pixels: over all arcs of 9 contiguous pixels on the
/// 16-pixel circle of radius 3, the best of the smallest difference by which the arc is brighter,
/// or darker, than the centre. A pixel is a FAST corner for threshold t exactly when its score
/// is greater than t. Scores below `min_score` are written as 0.
/// Reads 3 pixels beyond the row at `center` on all sides; `stride` in bytes.
void FastScoreRow(const uint8_t* center, ptrdiff_t stride, int width, uint8_t min_score,
                  uint8_t* score);

/// Columns where `middle` is a local maximum over the 3x3 neighbourhood and at least
/// `min_score` (> 0): greater than the neighbours above and to the left, not less than those below
/// and to the right, so that of a plateau one pixel remains. Reads one element beyond both ends.
void FastMaximaRow(const uint8_t* above, const uint8_t* middle, const uint8_t* below, int width,
                   uint8_t min_score, std::vector<int>* columns);

}  // namespace orb360
