// Per-target include guard: foreach_target includes this file once for each instruction set.
#if defined(ORB360_SLAM_DEPTH_ROW_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_SLAM_DEPTH_ROW_LANES_INL_H_
#undef ORB360_SLAM_DEPTH_ROW_LANES_INL_H_
#else
#define ORB360_SLAM_DEPTH_ROW_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "slam/depth/tested_row.h"

// Points of a TestedRow, one in each lane.
HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kMaxLanes>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;

HWY_INLINE V Constant(float x) { return hn::Set(D(), x); }

/// Adds `width` to negative columns and subtracts it from columns past the end.
HWY_INLINE VI Wrap(VI column, VI width) {
  const VI lifted = hn::Add(column, hn::IfThenElseZero(hn::Lt(column, hn::Zero(DI())), width));
  return hn::Sub(lifted, hn::IfThenZeroElse(hn::Lt(lifted, width), width));
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#endif
