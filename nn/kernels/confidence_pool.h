#pragma once

#include <cstdint>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Rule that is applied to the largest confidence c of a square.
enum class ConfidenceRule : std::uint8_t {
  kQuarter,     // c / 4, as published
  kSquareRoot,  // sqrt(c): a confidence that survives many levels
};

/// Halves the size: for each channel and 2 x 2 square, takes x and c from the pixel with the
/// largest c, the first one in row-major order among equals, and applies the rule to c. Height and
/// width of the inputs must be even. Planar floats. No halo is read, and rows of the outputs may be
/// overwritten up to the next multiple of kAlignment. A NaN among the confidences is never the
/// largest unless it comes first.
void ConfidencePool(const TensorView& x, const TensorView& c, const TensorView& y,
                    const TensorView& y_confidence, ConfidenceRule rule, int threads);

/// Computes row v of the result only, for every channel, on the calling thread and without checks.
/// It is for callers that have just written rows 2v and 2v + 1 of the inputs.
void ConfidencePoolRow(const TensorView& x, const TensorView& c, const TensorView& y,
                       const TensorView& y_confidence, ConfidenceRule rule, int v);

}  // namespace orb360::nn
