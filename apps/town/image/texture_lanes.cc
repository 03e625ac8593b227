#include "apps/town/image/texture_lanes.h"

#include <cstdint>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "apps/town/image/texture_lanes.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360::town {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kLanes>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;

/// Blends a channel of the four texels around a sample; 8 bits of the square root of the linear
/// value.
template <int kShift>
HWY_INLINE V Blend(VI t00, VI t01, VI t10, VI t11, V x, V y) {
  const D d;
  const DI di;
  const auto channel = [&](VI texel) HWY_ATTR {
    return hn::ConvertTo(d, hn::And(hn::ShiftRight<kShift>(texel), hn::Set(di, 255)));
  };
  const V a = channel(t00);
  const V b = channel(t10);
  const V lower = hn::MulAdd(x, hn::Sub(channel(t01), a), a);
  const V upper = hn::MulAdd(x, hn::Sub(channel(t11), b), b);
  const V root = hn::MulAdd(y, hn::Sub(upper, lower), lower);
  return hn::Mul(root, root);
}

HWY_INLINE void Add(V value, float* sum) {
  const D d;
  hn::Store(hn::MulAdd(value, hn::Set(d, 1.0F / (255 * 255)), hn::Load(d, sum)), d, sum);
}

void AddSamplesKernel(const std::array<const Texture*, kLanes>& textures, const Lanes& u,
                      const Lanes& v, const Lanes& level, Lanes3* sum) {
  const D d;
  const DI di;
  const size_t step = hn::Lanes(d);
  struct alignas(64) Integers : std::array<int32_t, kLanes> {};
  std::array<const uint32_t*, kLanes> texels;
  Integers width;
  Integers height;
  for (size_t i = 0; i < kLanes; ++i) {
    const Texture::Level& l = textures[i]->LevelAt(level[i]);
    texels[i] = textures[i]->TexelsOf(l);
    width[i] = l.width;
    height[i] = l.height;
  }
  // Positions with 8 fractional bits; texel centres are at halves.
  Lanes wx;
  Lanes wy;
  Integers first;
  for (size_t i = 0; i < kLanes; i += step) {
    const VI w = hn::Load(di, width.data() + i);
    const VI h = hn::Load(di, height.data() + i);
    const auto place = [&](const float* tiles, VI side) HWY_ATTR {
      const V texels256 = hn::Mul(hn::Load(d, tiles), hn::ConvertTo(d, hn::ShiftLeft<8>(side)));
      return hn::Sub(hn::ConvertTo(di, hn::Floor(texels256)), hn::Set(di, 128));
    };
    const auto weight = [&](VI at) HWY_ATTR {
      return hn::Mul(hn::ConvertTo(d, hn::And(at, hn::Set(di, 255))), hn::Set(d, 1.0F / 256));
    };
    const auto wrapped = [&](VI at, VI side) HWY_ATTR {
      return hn::And(hn::ShiftRight<8>(at), hn::Sub(side, hn::Set(di, 1)));
    };
    const VI x = place(u.data() + i, w);
    const VI y = place(v.data() + i, h);
    hn::Store(weight(x), d, wx.data() + i);
    hn::Store(weight(y), d, wy.data() + i);
    const VI stride = hn::Add(w, hn::Set(di, 1));
    hn::Store(hn::Add(hn::Mul(wrapped(y, h), stride), wrapped(x, w)), di, first.data() + i);
  }
  // Pairs of neighbours in a row.
  alignas(64) std::array<int32_t, 2 * kLanes> pairs0;
  alignas(64) std::array<int32_t, 2 * kLanes> pairs1;
  for (size_t i = 0; i < kLanes; ++i) {
    const uint32_t* row = texels[i] + first[i];
    std::memcpy(&pairs0[2 * i], row, 8);
    std::memcpy(&pairs1[2 * i], row + width[i] + 1, 8);
  }
  for (size_t i = 0; i < kLanes; i += step) {
    VI t00;
    VI t01;
    VI t10;
    VI t11;
    hn::LoadInterleaved2(di, pairs0.data() + 2 * i, t00, t01);
    hn::LoadInterleaved2(di, pairs1.data() + 2 * i, t10, t11);
    const V x = hn::Load(d, wx.data() + i);
    const V y = hn::Load(d, wy.data() + i);
    Add(Blend<0>(t00, t01, t10, t11, x, y), sum->x.data() + i);
    Add(Blend<8>(t00, t01, t10, t11, x, y), sum->y.data() + i);
    Add(Blend<16>(t00, t01, t10, t11, x, y), sum->z.data() + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::town
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::town {

HWY_EXPORT(AddSamplesKernel);

void AddSamples(const std::array<const Texture*, kLanes>& textures, const Lanes& u, const Lanes& v,
                const Lanes& level, Lanes3* sum) {
  HWY_DYNAMIC_DISPATCH(AddSamplesKernel)(textures, u, v, level, sum);
}

}  // namespace orb360::town
#endif
