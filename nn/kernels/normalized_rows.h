#pragma once

#include <cstddef>

#include "nn/kernels/normalized_convolution.h"

namespace orb360::nn {

// The arithmetic of NormalizedChain on single rows.

/// Number of floats in rows of NormalizedRow before column 0, and at least as many behind the last
/// one.
constexpr int kNormalizedRowMargin = 16;

/// NormalizedRows reads whole tiles of this many columns.
constexpr int kNormalizedTile = 32;

/// The channels of one row of values with confidences. For channel i, column 0 of the values is at
/// `x + i * x_stride`.
struct NormalizedRow {
  float* x = nullptr;
  float* c = nullptr;
  std::ptrdiff_t x_stride = 0;
  std::ptrdiff_t c_stride = 0;
};

/// Number of output rows that are computed at once.
constexpr int kNormalizedRows = 3;

/// Computes `rows` rows of output, at most kNormalizedRows. `in` contains the size() + rows - 1
/// rows that their windows cover, from the top. There x is the product of value and confidence;
/// both have reach() columns of padding on either side.
///
/// With `as_products`, x of the output is the product too. Rows of the output may be overwritten up
/// to the next multiple of kAlignment.
void NormalizedRows(const NormalizedConvolution& layer, const NormalizedRow* in, int rows,
                    int width, const NormalizedRow* out, bool as_products);

/// Forms a row of one channel as NormalizedRows reads it, without its padding, from `width` values
/// and confidences, or, if `doubled`, from half as many, each of which stands for two columns.
void MultiplyRow(const float* x, const float* c, int width, bool doubled, float* product,
                 float* confidence);

}  // namespace orb360::nn
