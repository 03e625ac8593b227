// Per-target include guard: foreach_target includes this file once for each instruction set.
#if defined(ORB360_NN_KERNELS_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_NN_KERNELS_MATH_INL_H_
#undef ORB360_NN_KERNELS_MATH_INL_H_
#else
#define ORB360_NN_KERNELS_MATH_INL_H_
#endif

#include <limits>

#include <hwy/contrib/math/math-inl.h>

// Highway's functions of vectors of floats, extended to all inputs: NaN stays NaN, and inputs
// beyond the documented range give the limit. Errors are in units in the last place of normal
// results, without the half unit of rounding. ExpOfWeight is the project's own.
HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

template <class V, class F>
HWY_INLINE V UnlessNan(V x, F y) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::IfThenElse(hn::Eq(x, x), y, x);
}

/// e^x, within 1 unit.
template <class D, class V>
HWY_INLINE V TotalExp(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  // Highway's function is correct up to 104, where the result is already infinite.
  return UnlessNan(x, hn::Exp(d, hn::Min(x, hn::Set(d, 104.0f))));
}

/// e^x for weights of a softmax, where x is at most 0: within 4 units and a relative error of 2^-23
/// |x|, and 2^-126 where e^x is less. Has a third of the operations of TotalExp.
template <class D, class V>
HWY_INLINE V ExpOfWeight(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::RebindToSigned<D> di;
  const V log2_e = hn::Set(d, 1.44269504f);
  const V limited = hn::Max(x, hn::Set(d, -87.3365f));  // ln 2^-126
  const V whole = hn::Round(hn::Mul(limited, log2_e));
  const V rest = hn::MulSub(limited, log2_e, whole);
  // 2^rest between -1/2 and 1/2, of the least largest relative error: 9e-8.
  V y = hn::MulAdd(rest, hn::Set(d, 0.00132647203f), hn::Set(d, 0.00967151299f));
  y = hn::MulAdd(rest, y, hn::Set(d, 0.0555073358f));
  y = hn::MulAdd(rest, y, hn::Set(d, 0.240222424f));
  y = hn::MulAdd(rest, y, hn::Set(d, 0.693147004f));
  y = hn::MulAdd(rest, y, hn::Set(d, 1.0f));
  const auto exponent = hn::ShiftLeft<23>(hn::ConvertTo(di, whole));
  return UnlessNan(x, hn::BitCast(d, hn::Add(hn::BitCast(di, y), exponent)));
}

/// ln x, within 4 units; -infinity at zero, NaN below.
template <class D, class V>
HWY_INLINE V TotalLog(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  const V zero = hn::Zero(d);
  const V infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const V nan = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  V y = hn::IfThenElse(hn::Eq(x, infinity), x, hn::Log(d, x));
  y = hn::IfThenElse(hn::Eq(x, zero), hn::Neg(infinity), y);
  return UnlessNan(x, hn::IfThenElse(hn::Lt(x, zero), nan, y));
}

/// tanh x, within 4 units.
template <class D, class V>
HWY_INLINE V TotalTanh(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  return UnlessNan(x, hn::Tanh(d, x));
}

/// 1 / (1 + e^-x), within 3 units.
template <class D, class V>
HWY_INLINE V TotalSigmoid(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  const V one = hn::Set(d, 1.0f);
  const V e = hn::Exp(d, hn::Neg(hn::Abs(x)));  // at most 1, so nothing overflows
  const V numerator = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), e, one);
  return UnlessNan(x, hn::Div(numerator, hn::Add(one, e)));
}

/// ln(1 + e^x), within 4 units.
template <class D, class V>
HWY_INLINE V TotalSoftplus(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  const V e = hn::Exp(d, hn::Neg(hn::Abs(x)));
  return UnlessNan(x, hn::Add(hn::Max(x, hn::Zero(d)), hn::Log1p(d, e)));
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#endif
