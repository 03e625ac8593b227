// Writes blocks of channels to planes, for each instruction set. Included by files that Highway
// compiles for all of them.

#if defined(ORB360_NN_KERNELS_STORE_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_NN_KERNELS_STORE_PLANES_INL_H_
#undef ORB360_NN_KERNELS_STORE_PLANES_INL_H_
#else
#define ORB360_NN_KERNELS_STORE_PLANES_INL_H_
#endif

#include <algorithm>
#include <cstddef>

#include <hwy/highway.h>

#include "nn/kernels/convolution_tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

// Pixels whose sums are collected before they are written to planes: a few tiles.
constexpr int kStripPixels = 56;

#if HWY_TARGET != HWY_SCALAR
// Channels and pixels of the squares that are transposed in registers.
using SquareD = hn::CappedTag<float, 8>;
constexpr int kSquare = static_cast<int>(hn::MaxLanes(SquareD()));

// Turns the channels of pixels into the pixels of channels.
HWY_INLINE void Transpose(hn::Vec<SquareD> (&x)[kSquare]) {
  const SquareD d;
  const hn::Repartition<double, SquareD> pairs;
  // Within 128 bits: squares of 4 x 4.
  for (int i = 0; i < kSquare; i += 4) {
    const auto low01 = hn::BitCast(pairs, hn::InterleaveLower(d, x[i], x[i + 1]));
    const auto low23 = hn::BitCast(pairs, hn::InterleaveLower(d, x[i + 2], x[i + 3]));
    const auto high01 = hn::BitCast(pairs, hn::InterleaveUpper(d, x[i], x[i + 1]));
    const auto high23 = hn::BitCast(pairs, hn::InterleaveUpper(d, x[i + 2], x[i + 3]));
    x[i] = hn::BitCast(d, hn::InterleaveLower(pairs, low01, low23));
    x[i + 1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low01, low23));
    x[i + 2] = hn::BitCast(d, hn::InterleaveLower(pairs, high01, high23));
    x[i + 3] = hn::BitCast(d, hn::InterleaveUpper(pairs, high01, high23));
  }
  if constexpr (kSquare == 8) {
    for (int i = 0; i < 4; ++i) {
      const auto low = hn::ConcatLowerLower(d, x[i + 4], x[i]);
      const auto high = hn::ConcatUpperUpper(d, x[i + 4], x[i]);
      x[i] = low;
      x[i + 4] = high;
    }
  }
}
#endif

// Where a group of output channels lies in planes of floats.
struct Planes {
  int channels;  // that exist
  float* out;    // the first pixel
  ptrdiff_t out_plane;
  const float* residual;  // null if there is none
  ptrdiff_t residual_plane;
  float slope;
};

// Writes sums, [block][kStripPixels][channel], to planes after residual and activation.
HWY_NOINLINE void StorePlanes(const float* strip, int pixels, const Planes& to) {
  const auto block_of = [&](int channel) {
    return strip + channel / kBlock * kStripPixels * kBlock + channel % kBlock;
  };
  int whole = 0;
#if HWY_TARGET != HWY_SCALAR
  const SquareD d;
  const auto slope = hn::Set(d, to.slope);
  // The last squares may overlap, but for a residual, which may be in the place of the output.
  whole = to.residual == nullptr && pixels >= kSquare ? pixels : pixels / kSquare * kSquare;
  for (int c = 0; c < to.channels; c += kSquare) {
    const float* from = block_of(c);
    const int channels = std::min(kSquare, to.channels - c);
    for (int first = 0; first < whole; first += kSquare) {
      const int p = std::min(first, pixels - kSquare);
      hn::Vec<SquareD> x[kSquare];
      HWY_UNROLL(8)
      for (int i = 0; i < kSquare; ++i) x[i] = hn::Load(d, from + (p + i) * kBlock);
      Transpose(x);
      for (int i = 0; i < channels; ++i) {
        auto value = x[i];
        if (to.residual != nullptr) {
          value = hn::Add(value, hn::LoadU(d, to.residual + (c + i) * to.residual_plane + p));
        }
        value = hn::IfThenElse(hn::Gt(value, hn::Zero(d)), value, hn::Mul(value, slope));
        hn::StoreU(value, d, to.out + (c + i) * to.out_plane + p);
      }
    }
  }
#endif
  for (int c = 0; c < to.channels; ++c) {
    for (int p = whole; p < pixels; ++p) {
      float value = block_of(c)[p * kBlock];
      if (to.residual != nullptr) value += to.residual[c * to.residual_plane + p];
      to.out[c * to.out_plane + p] = value > 0 ? value : to.slope * value;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#endif  // ORB360_NN_KERNELS_STORE_PLANES_INL_H_
