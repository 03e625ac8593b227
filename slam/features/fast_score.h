#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace orb360 {

/// FAST-9 corner scores of `width` neighbouring pixels. Consider all arcs of 9 contiguous pixels on
/// the 16-pixel circle of radius 3, and the smallest difference by which an arc is brighter (or
/// darker) than the centre; the score is the largest of these. A pixel is a FAST corner for
/// threshold t exactly when its score is greater than t. Scores below `min_score` are written as 0.
/// Reads 3 pixels beyond the row at `center` on all sides; `stride` is in bytes.
void FastScoreRow(const uint8_t* center, ptrdiff_t stride, int width, uint8_t min_score,
                  uint8_t* score);

/// Finds the columns where `middle` is a local maximum over the 3x3 neighbourhood and at least
/// `min_score` (> 0). The score must exceed the neighbours above and to the left and must not be
/// less than those below and to the right, so that one pixel of a plateau remains. Reads one
/// element beyond both ends.
void FastMaximaRow(const uint8_t* above, const uint8_t* middle, const uint8_t* below, int width,
                   uint8_t min_score, std::vector<int>* columns);

}  // namespace orb360
