#include "slam/features/patch_descriptor.h"

#include <cmath>
#include <cstring>

#include "slam/features/comparison_pattern.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/features/patch_descriptor.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// atan(y / x) for x >= 0 with |error| < 2e-6 rad, by a minimax polynomial in the smaller ratio.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V AtanOfRatio(D d, V y, V x) {
  const V ay = hn::Abs(y);
  const V ax = hn::Abs(x);
  const V large = hn::Max(hn::Max(ax, ay), hn::Set(d, 1e-30f));
  const V t = hn::Div(hn::Min(ax, ay), large);
  const V s = hn::Mul(t, t);
  // Abramowitz & Stegun 4.4.49.
  V p = hn::Set(d, 0.0028662257f);
  for (const float c : {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f,
                        -0.1420889944f, 0.1999355085f, -0.3333314528f, 1.0f}) {
    p = hn::MulAdd(p, s, hn::Set(d, c));
  }
  const V small = hn::Mul(p, t);
  const V angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 1.57079633f), small), small);
  return hn::CopySign(angle, y);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V Atan2(D d, V y, V x) {
  const V right = AtanOfRatio(d, y, x);
  const V left = hn::Sub(hn::CopySign(hn::Set(d, 3.14159265f), y), right);
  return hn::IfThenElse(hn::Lt(x, hn::Zero(d)), left, right);
}

// atan(t) / t for a small t, computed from its square.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V AtanSeries(D d, V square) {
  return hn::MulAdd(hn::MulAdd(square, hn::Set(d, 0.2f), hn::Set(d, -1.0f / 3.0f)), square,
                    hn::Set(d, 1.0f));
}

// Byte offsets, from the centre, of the pixels at tangent coordinates (a, b).
template <class D, class V = hn::Vec<D>, class DI = hn::RebindToSigned<D>>
HWY_INLINE hn::Vec<DI> Offsets(D d, const TangentSampling& at, int stride, V a, V b) {
  const DI di;
  const V east = hn::Mul(a, hn::Set(d, at.k));
  const V south = hn::Mul(b, hn::Set(d, at.k));
  const V one = hn::Set(d, 1.0f);
  const V secant = hn::Set(d, 1.0f / at.cosine);
  // Offsets of pixels that do not lie beyond the sides of the band.
  const auto offsets = [&](V longitude, V down) HWY_ATTR {
    const V columns = hn::Round(hn::Mul(hn::Set(d, at.fx), longitude));
    const V rows = hn::Round(hn::Mul(hn::Set(d, -at.fy), down));
    return hn::ConvertTo(di, hn::MulAdd(rows, hn::Set(d, static_cast<float>(stride)), columns));
  };
  if (at.order == TangentSampling::Order::kSecond) {
    const V tangent = hn::Mul(hn::Set(d, at.sine), secant);
    const V longitude = hn::Mul(hn::Mul(east, secant), hn::NegMulAdd(tangent, south, one));
    const V sag = hn::Mul(hn::Mul(hn::Set(d, 0.5f), tangent), hn::Mul(east, east));
    return offsets(longitude, hn::Add(south, sag));
  }
  if (at.order == TangentSampling::Order::kSeries) {
    // 1 / forward = sec / (1 + w).
    const V w = hn::Mul(hn::Mul(hn::Set(d, at.sine), secant), south);
    V inverse = hn::Sub(one, w);
    for (int i = 0; i < 3; ++i) inverse = hn::NegMulAdd(inverse, w, one);
    const V q = hn::Mul(hn::Mul(east, secant), inverse);
    const V q2 = hn::Mul(q, q);
    // forward (sqrt(1 + q^2) - 1).
    const V e = hn::Mul(hn::Mul(q, east), hn::NegMulAdd(hn::Set(d, 0.125f), q2, hn::Set(d, 0.5f)));
    const V ce = hn::Mul(hn::Set(d, at.cosine), e);
    const V shrink = hn::NegMulAdd(ce, hn::Sub(one, ce), one);
    const V p = hn::Mul(hn::MulAdd(hn::Set(d, at.sine), e, south), shrink);
    return offsets(hn::Mul(q, AtanSeries(d, q2)), hn::Mul(p, AtanSeries(d, hn::Mul(p, p))));
  }
  // The exact projection in a frame whose meridian is the patch's own, so that nothing depends on
  // the longitude.
  const V forward = hn::MulAdd(hn::Set(d, at.sine), south, hn::Set(d, at.cosine));
  const V up = hn::NegMulAdd(hn::Set(d, at.cosine), south, hn::Set(d, at.sine));
  const V longitude = Atan2(d, east, forward);
  const V horizontal = hn::Sqrt(hn::MulAdd(east, east, hn::Mul(forward, forward)));
  const V latitude = AtanOfRatio(d, up, horizontal);
  auto v = hn::ConvertTo(di, hn::MulAdd(hn::Set(d, at.fy), latitude, hn::Set(d, 0.5f * at.height)));
  v = hn::Min(hn::Max(v, hn::Zero(di)), hn::Set(di, at.height - 1));
  auto u = hn::Add(hn::NearestInt(hn::Mul(hn::Set(d, at.fx), longitude)), hn::Set(di, at.u_index));
  const auto width = hn::Set(di, at.width);
  u = hn::IfThenElse(hn::Lt(u, hn::Zero(di)), hn::Add(u, width), u);
  u = hn::IfThenElse(hn::Gt(u, hn::Set(di, at.width - 1)), hn::Sub(u, width), u);
  return hn::Add(hn::Mul(hn::Sub(v, hn::Set(di, at.v_index)), hn::Set(di, stride)),
                 hn::Sub(u, hn::Set(di, at.u_index)));
}

// The pixels at those offsets. Reads three bytes beyond them, which the margins of a level allow.
template <class DI, class VI = hn::Vec<DI>>
HWY_INLINE VI GatherPixels(DI di, const uint8_t* center, VI offsets) {
  const VI words = hn::GatherOffset(di, reinterpret_cast<const int32_t*>(center), offsets);
  return hn::And(words, hn::Set(di, 0xFF));
}

OrientedDescriptor DescribePatch(const uint8_t* center, ptrdiff_t stride_bytes,
                                 const TangentSampling& at) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int stride = static_cast<int>(stride_bytes);

  const MomentPattern& moments = OrientationPattern();
  auto east_sum = hn::Zero(d);
  auto south_sum = hn::Zero(d);
  for (size_t i = 0; i < moments.east.size(); i += lanes) {
    const auto a = hn::LoadU(d, moments.east.data() + i);
    const auto b = hn::LoadU(d, moments.south.data() + i);
    const auto pixels = hn::ConvertTo(d, GatherPixels(di, center, Offsets(d, at, stride, a, b)));
    east_sum = hn::MulAdd(a, pixels, east_sum);  // whole numbers below 2^24: exact in any order
    south_sum = hn::MulAdd(b, pixels, south_sum);
  }
  OrientedDescriptor result{std::atan2(hn::GetLane(hn::SumOfLanes(d, south_sum)),
                                       hn::GetLane(hn::SumOfLanes(d, east_sum))),
                            {}};

  const ComparisonPattern& pattern = DescriptorPattern();
  const auto cosine = hn::Set(d, std::cos(result.angle));
  const auto sine = hn::Set(d, std::sin(result.angle));
  const auto sample = [&](const float* east, const float* south) HWY_ATTR {
    const auto a = hn::LoadU(d, east);
    const auto b = hn::LoadU(d, south);
    const auto turned_a = hn::NegMulAdd(sine, b, hn::Mul(cosine, a));
    const auto turned_b = hn::MulAdd(cosine, b, hn::Mul(sine, a));
    return GatherPixels(di, center, Offsets(d, at, stride, turned_a, turned_b));
  };
  for (int i = 0; i < ComparisonPattern::kPairs; i += lanes) {
    const auto first = sample(&pattern.first_east[i], &pattern.first_south[i]);
    const auto second = sample(&pattern.second_east[i], &pattern.second_south[i]);
    uint8_t mask[8] = {};
    hn::StoreMaskBits(di, hn::Lt(first, second), mask);
    uint64_t bits = 0;
    std::memcpy(&bits, mask, sizeof(mask));
    result.bits[i / 64] |= bits << (i % 64);
  }
  return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(DescribePatch);

OrientedDescriptor DescribePatch(const uint8_t* center, ptrdiff_t stride,
                                 const TangentSampling& sampling) {
  return HWY_DYNAMIC_DISPATCH(DescribePatch)(center, stride, sampling);
}

}  // namespace orb360
#endif
