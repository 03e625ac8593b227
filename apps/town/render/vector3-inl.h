// Per-target include guard: foreach_target includes this file once for each instruction set.
#if defined(ORB360_TOWN_RENDER_VECTOR3_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_TOWN_RENDER_VECTOR3_INL_H_
#undef ORB360_TOWN_RENDER_VECTOR3_INL_H_
#else
#define ORB360_TOWN_RENDER_VECTOR3_INL_H_
#endif

#include <hwy/highway.h>

#include "apps/town/image/lanes.h"
#include "apps/town/world/mesh.h"

// Three-dimensional vectors, one in each lane.
HWY_BEFORE_NAMESPACE();
namespace orb360::town {
namespace HWY_NAMESPACE {

using D = hwy::HWY_NAMESPACE::CappedTag<float, kLanes>;
using DI = hwy::HWY_NAMESPACE::RebindToSigned<D>;
using V = hwy::HWY_NAMESPACE::Vec<D>;
using VI = hwy::HWY_NAMESPACE::Vec<DI>;

HWY_INLINE V Constant(float x) { return hwy::HWY_NAMESPACE::Set(D(), x); }

struct V3 {
  V x;
  V y;
  V z;
};

HWY_INLINE V3 Constant3(const Vector3f& v) {
  return {Constant(v.x()), Constant(v.y()), Constant(v.z())};
}
HWY_INLINE V3 Load3(const float* x, const float* y, const float* z) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::Load(D(), x), hn::Load(D(), y), hn::Load(D(), z)};
}
HWY_INLINE V3 Load3(const Lanes3& from, size_t i) {
  return Load3(from.x.data() + i, from.y.data() + i, from.z.data() + i);
}
HWY_INLINE void Store3(const V3& v, Lanes3* to, size_t i) {
  namespace hn = hwy::HWY_NAMESPACE;
  hn::Store(v.x, D(), to->x.data() + i);
  hn::Store(v.y, D(), to->y.data() + i);
  hn::Store(v.z, D(), to->z.data() + i);
}
HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator*(V s, const V3& a) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
/// The product channel by channel.
HWY_INLINE V3 Product(const V3& a, const V3& b) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
/// s * a + b.
HWY_INLINE V3 MulAdd3(V s, const V3& a, const V3& b) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
HWY_INLINE V Dot(const V3& a, const V3& b) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  namespace hn = hwy::HWY_NAMESPACE;
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE V3 Unit(const V3& a) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::Div(Constant(1), hn::Sqrt(Dot(a, a))) * a;
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::town
HWY_AFTER_NAMESPACE();

#endif  // include guard
