// The transforms of tiles for Winograd's method, for each instruction set. Included by files that
// Highway compiles for all of them.

#if defined(ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
#undef ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
#else
#define ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
#endif

#include "nn/kernels/convolution_tile-inl.h"
#include "nn/kernels/winograd_points.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

// Transforms six inputs, `step` apart. Every coefficient is that of the product of (x - q) over the
// other points q.
template <int kStep>
HWY_INLINE void TransformInput(const V* in, V* out) {
  const D d;
  const V a = hn::Set(d, static_cast<float>(kA));
  const V b = hn::Set(d, static_cast<float>(kB));
  const V half = hn::Set(d, 0.5f);
  const V two = hn::Set(d, 2.0f);
  const V five_halves = hn::Set(d, 2.5f);  // a^2 + b^2
  const V x0 = in[0], x1 = in[kStep], x2 = in[2 * kStep], x3 = in[3 * kStep], x4 = in[4 * kStep],
          x5 = in[5 * kStep];
  const V even_a = hn::NegMulAdd(two, x2, x4);
  const V odd_a = hn::NegMulAdd(two, x1, x3);
  const V even_b = hn::NegMulAdd(half, x2, x4);
  const V odd_b = hn::NegMulAdd(half, x1, x3);
  out[0] = hn::NegMulAdd(five_halves, x2, hn::Add(x0, x4));
  out[kStep] = hn::MulAdd(a, odd_a, even_a);
  out[2 * kStep] = hn::NegMulAdd(a, odd_a, even_a);
  out[3 * kStep] = hn::MulAdd(b, odd_b, even_b);
  out[4 * kStep] = hn::NegMulAdd(b, odd_b, even_b);
  out[5 * kStep] = hn::NegMulAdd(five_halves, x3, hn::Add(x1, x5));
}

// Transforms six sums of products, `step` apart, to four outputs: output i sums point^i.
template <int kInStep, int kOutStep>
HWY_INLINE void TransformOutput(const V* in, V* out) {
  const D d;
  const V a = hn::Set(d, static_cast<float>(kA));
  const V b = hn::Set(d, static_cast<float>(kB));
  const V plus_a = hn::Add(in[kInStep], in[2 * kInStep]);
  const V minus_a = hn::Mul(a, hn::Sub(in[kInStep], in[2 * kInStep]));
  const V plus_b = hn::Add(in[3 * kInStep], in[4 * kInStep]);
  const V minus_b = hn::Mul(b, hn::Sub(in[3 * kInStep], in[4 * kInStep]));
  const V half = hn::Set(d, 0.5f);
  const V two = hn::Set(d, 2.0f);
  out[0] = hn::Add(in[0], hn::Add(plus_a, plus_b));
  out[kOutStep] = hn::Add(minus_a, minus_b);
  out[2 * kOutStep] = hn::MulAdd(half, plus_a, hn::Mul(two, plus_b));
  out[3 * kOutStep] = hn::MulAdd(half, minus_a, hn::MulAdd(two, minus_b, in[5 * kInStep]));
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#endif  // ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
