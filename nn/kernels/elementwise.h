#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

// Functions of one element, or of two elements at the same position. Floats; inputs and output have
// the same shape and layout, planar or blocked, and may be the same tensor. Memory behind a row of
// the output is overwritten up to the next multiple of kAlignment, so halos must be filled
// afterwards. The channels that fill up the last block stay zero. NaN stays NaN in all of them.

/// x, or 0 where x < 0.
void Relu(const TensorView& x, const TensorView& y, int threads);
/// x, or slope * x where x < 0.
void LeakyRelu(const TensorView& x, float slope, const TensorView& y, int threads);
void Tanh(const TensorView& x, const TensorView& y, int threads);
/// 1 / (1 + e^-x).
void Sigmoid(const TensorView& x, const TensorView& y, int threads);
/// ln(1 + e^x).
void Softplus(const TensorView& x, const TensorView& y, int threads);
void Exp(const TensorView& x, const TensorView& y, int threads);
/// ln x: -infinity at 0, NaN below.
void Log(const TensorView& x, const TensorView& y, int threads);
/// x limited to [minimum, maximum]; requires minimum <= maximum.
void Clamp(const TensorView& x, float minimum, float maximum, const TensorView& y, int threads);
/// scale * x + offset.
void Affine(const TensorView& x, float scale, float offset, const TensorView& y, int threads);

void Add(const TensorView& a, const TensorView& b, const TensorView& y, int threads);
void Multiply(const TensorView& a, const TensorView& b, const TensorView& y, int threads);

}  // namespace orb360::nn
