#pragma once

#include "nn/kernels/convolution_winograd.h"

namespace orb360::nn {

constexpr int kOut = kWinogradTile;  // outputs of a tile in a row

// Inputs of a tile in a row, and products of it. With a stride of 2 every second input from the
// first one on, before the first output's centre, has two taps of the filter, F(4, 2) with 5
// products; the others, the centres, have one, 4 products.
constexpr int InputsOf(int stride) { return stride == 1 ? kOut + 3 - 1 : 2 * kOut + 1; }
constexpr int ProductsOf(int stride) { return InputsOf(stride) * InputsOf(stride); }

// Transformed filters in a row. With a stride of 2 the last one is multiplied with all centres.
constexpr int kFilters = 6;
constexpr int kPairProducts = kFilters - 1;
// The products in a row that take filter `f` are f, f + 1, ... before this one.
constexpr int EndOfProducts(int stride, int f) {
  return stride == 2 && f == kPairProducts ? InputsOf(2) : f + 1;
}

// With a stride of 1 polynomials of degree 5 are evaluated at 0, a, -a, b, -b and infinity, where a
// = 1/sqrt(2) and b = sqrt(2). Since a b = 1 the numbers stay small, and the error is several times
// smaller than with the usual 1 and 2. With a stride of 2 they have degree 4, and the points are 0,
// 1/2, -1, 2 and infinity for the same reason.
constexpr double kA = 0.70710678118654752440;
constexpr double kB = 2 * kA;

}  // namespace orb360::nn
