#pragma once

#include <cstdint>

#include "nn/tensor.h"

namespace orb360::nn {

/// What becomes of the largest confidence c of a square.
enum class ConfidenceRule : std::uint8_t {
  kQuarter,     // c / 4, as published
  kSquareRoot,  // sqrt(c): a confidence that survives many levels
};

/// Halves a picture: for each channel and 2 x 2 square, x and c from where c is largest, the first
/// in row-major order among equals; then the rule is applied to c. Height and width of the inputs
/// must be even. Planar floats; no halo is read, and rows of the outputs may be overwritten up to
/// the next multiple of kAlignment. A NaN among the confidences is never the largest unless it
/// stands first.
void ConfidencePool(const TensorView& x, const TensorView& c, const TensorView& y,
                    const TensorView& y_confidence, ConfidenceRule rule, int threads);

/// Row v of the result alone, of every channel, on the calling thread and without checks: for those
/// who have just written rows 2v and 2v + 1 of the inputs.
void ConfidencePoolRow(const TensorView& x, const TensorView& c, const TensorView& y,
                       const TensorView& y_confidence, ConfidenceRule rule, int v);

}  // namespace orb360::nn
