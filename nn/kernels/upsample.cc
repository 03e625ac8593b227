#include "nn/kernels/upsample.h"

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/upsample.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlock = BlockOf(DataType::kFloat);
using BlockedD = hn::CappedTag<float, kBlock>;
// Half a cache line becomes a whole one, so that no vector reaches over the end of a tensor's row.
using PlanarD = hn::CappedTag<float, kBlock / 2>;

// Writes the two pixels for each of `count` pixels. left(u) and right(u) return them: as vectors of
// columns in a planar row, or as parts of the channels of one pixel in a blocked one.
template <class Left, class Right>
HWY_INLINE void DoublePlanar(int count, float* to, const Left& left, const Right& right) {
  const PlanarD d;
  for (int u = 0; u < count; u += static_cast<int>(hn::Lanes(d))) {
    hn::StoreInterleaved2(left(d, u), right(d, u), d, to + 2 * u);
  }
}

template <class Left, class Right>
HWY_INLINE void DoubleBlocked(int count, float* to, const Left& left, const Right& right) {
  const BlockedD d;
  for (int u = 0; u < count; ++u) {
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(left(d, u * kBlock + i), d, to + 2 * u * kBlock + i);
      hn::Store(right(d, u * kBlock + i), d, to + (2 * u + 1) * kBlock + i);
    }
  }
}

template <class Left, class Right>
HWY_INLINE void DoubleRow(bool is_blocked, int count, float* to, const Left& left,
                          const Right& right) {
  if (is_blocked) {
    DoubleBlocked(count, to, left, right);
  } else {
    DoublePlanar(count, to, left, right);
  }
}

void NearestRow(const float* from, bool is_blocked, int count, float* to) {
  const auto same = [&](auto d, int at) HWY_ATTR { return hn::LoadU(d, from + at); };
  DoubleRow(is_blocked, count, to, same, same);
}

// `near` is the input row that contains the result's row; `far` is the row from which it is a
// quarter of a pixel away.
void BilinearRow(const float* near, const float* far, bool is_blocked, int count, float* to) {
  const int step = is_blocked ? kBlock : 1;
  const auto mix = [](auto d, auto a, auto b) HWY_ATTR {
    return hn::MulAdd(hn::Set(d, 0.75f), a, hn::Mul(hn::Set(d, 0.25f), b));
  };
  const auto column = [&](auto d, int at) HWY_ATTR {
    return mix(d, hn::LoadU(d, near + at), hn::LoadU(d, far + at));
  };
  DoubleRow(
      is_blocked, count, to,
      [&](auto d, int at) HWY_ATTR { return mix(d, column(d, at), column(d, at - step)); },
      [&](auto d, int at) HWY_ATTR { return mix(d, column(d, at), column(d, at + step)); });
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {
namespace {

void CheckDoubling(const TensorView& x, const TensorView& y) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat);
  ORB360_CHECK(x.layout == y.layout);
  ORB360_CHECK((y.shape == Shape{x.shape.channels, 2 * x.shape.height, 2 * x.shape.width}));
}

}  // namespace

HWY_EXPORT(NearestRow);
HWY_EXPORT(BilinearRow);

void UpsampleNearest(const TensorView& x, const TensorView& y, int threads) {
  CheckDoubling(x, y);
  const auto nearest_row = HWY_DYNAMIC_DISPATCH(NearestRow);
  const bool is_blocked = x.layout == Layout::kBlocked;
  const int rows = y.shape.height;
  const int planes = y.planes();
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < planes * rows; ++line) {
    const int plane = line / rows;
    const int v = line % rows;
    nearest_row(x.row<float>(plane, v / 2), is_blocked, x.shape.width, y.row<float>(plane, v));
  }
}

void UpsampleBilinear(const TensorView& x, const TensorView& y, Padding padding, int threads) {
  CheckDoubling(x, y);
  FillHalo(x, padding, kUpsampleBilinearHalo);
  const auto bilinear_row = HWY_DYNAMIC_DISPATCH(BilinearRow);
  const bool is_blocked = x.layout == Layout::kBlocked;
  const int rows = y.shape.height;
  const int planes = y.planes();
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < planes * rows; ++line) {
    const int plane = line / rows;
    const int v = line % rows;
    // An even row lies a quarter of a pixel before its input row, an odd one a quarter behind it.
    const float* far = x.row<float>(plane, v % 2 == 0 ? v / 2 - 1 : v / 2 + 1);
    bilinear_row(x.row<float>(plane, v / 2), far, is_blocked, x.shape.width,
                 y.row<float>(plane, v));
  }
}

}  // namespace orb360::nn
#endif
