#pragma once

#include "nn/kernels/convolution_winograd.h"

namespace orb360::nn {

constexpr int kOut = kWinogradTile;  // outputs of a tile in a row
constexpr int kIn = kOut + 3 - 1;    // inputs of a tile in a row
constexpr int kProducts = kIn * kIn;

// Polynomials of degree 5 are evaluated at 0, a, -a, b, -b and infinity, where a = 1/sqrt(2) and b
// = sqrt(2). Since a b = 1 the numbers stay small, and the error is several times smaller than with
// the usual 1 and 2.
constexpr double kA = 0.70710678118654752440;
constexpr double kB = 2 * kA;

}  // namespace orb360::nn
