// Per-target include guard: foreach_target includes this file once for each instruction set.
#if defined(ORB360_NN_KERNELS_EVEN_ODD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_NN_KERNELS_EVEN_ODD_INL_H_
#undef ORB360_NN_KERNELS_EVEN_ODD_INL_H_
#else
#define ORB360_NN_KERNELS_EVEN_ODD_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

/// Loads columns 2u, 2u + 2, … and 2u + 1, 2u + 3, … of a planar row of `columns` floats, where u
/// is a multiple of the number of lanes, which is at most a cache line. Memory behind the row's
/// last cache line is not read; lanes for columns behind the last one are undefined.
template <class D, class V>
HWY_INLINE void LoadEvenOdd(D d, const float* row, int u, int columns, V& even, V& odd) {
  namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_SCALAR
  (void)columns;
  hn::LoadInterleaved2(d, row + 2 * u, even, odd);
#else
  const int second = 2 * u + static_cast<int>(hn::Lanes(d));
  const V low = hn::LoadU(d, row + 2 * u);
  const V high = second < columns ? hn::LoadU(d, row + second) : low;
  even = hn::ConcatEven(d, high, low);
  odd = hn::ConcatOdd(d, high, low);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#endif
