// Per-target include guard: foreach_target includes this file once for each instruction set.
#if defined(ORB360_SLAM_GEOMETRY_ANGLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_SLAM_GEOMETRY_ANGLE_INL_H_
#undef ORB360_SLAM_GEOMETRY_ANGLE_INL_H_
#else
#define ORB360_SLAM_GEOMETRY_ANGLE_INL_H_
#endif

#include <numbers>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {

/// The angle of (x, y) from the x axis in each lane, in -pi..pi; 0 for the origin.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V Angle(D d, V y, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr float kPi = std::numbers::pi_v<float>;
  const V run = hn::Abs(x);
  const V rise = hn::Abs(y);
  const V longer = hn::Max(hn::Max(run, rise), hn::Set(d, 1e-30f));
  const V acute = hn::Atan(d, hn::Div(hn::Min(run, rise), longer));
  const V first = hn::IfThenElse(hn::Gt(rise, run), hn::Sub(hn::Set(d, 0.5f * kPi), acute), acute);
  const V upper = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, kPi), first), first);
  return hn::CopySign(upper, y);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#endif
