#include "apps/town/render/shading_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "apps/town/render/shading_kernels.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "apps/town/render/vector3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::town {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr auto kFoliage = static_cast<int32_t>(Finish::kFoliage);
constexpr auto kGlass = static_cast<int32_t>(Finish::kGlass);
constexpr auto kPaint = static_cast<int32_t>(Finish::kPaint);
constexpr auto kLamp = static_cast<int32_t>(Finish::kLamp);

/// The values that are interpolated over a triangle, at one of its corners.
struct Corner {
  V u;
  V v;
  V3 normal;
  V openness;
  V3 tint;
};

template <int kByte>
HWY_INLINE V Byte(VI word) {
  return hn::ConvertTo(D(), hn::And(hn::ShiftRight<8 * kByte>(word), hn::Set(DI(), 255)));
}
template <int kByte>
HWY_INLINE V SignedByte(VI word) {
  return hn::ConvertTo(D(), hn::ShiftRight<24>(hn::ShiftLeft<24 - 8 * kByte>(word)));
}

HWY_INLINE Corner LoadCorner(const Vertex* vertices) {
  VI u;
  VI v;
  VI normal_and_openness;
  VI tint;
  hn::LoadInterleaved4(DI(), reinterpret_cast<const int32_t*>(vertices), u, v, normal_and_openness,
                       tint);
  return {hn::BitCast(D(), u),
          hn::BitCast(D(), v),
          {SignedByte<0>(normal_and_openness), SignedByte<1>(normal_and_openness),
           SignedByte<2>(normal_and_openness)},
          Byte<3>(normal_and_openness),
          {Byte<0>(tint), Byte<1>(tint), Byte<2>(tint)}};
}

HWY_INLINE V3 LoadPosition(const std::array<float, 4>* positions) {
  V x;
  V y;
  V z;
  V unused;
  hn::LoadInterleaved4(D(), positions->data(), x, y, z, unused);
  return {x, y, z};
}

/// log2(x) for positive x, within 0.09, which is sufficient to choose a mip level.
HWY_INLINE V FastLog2(V x) {
  return hn::MulAdd(hn::ConvertTo(D(), hn::BitCast(DI(), x)), Constant(0x1p-23F), Constant(-127));
}

HWY_INLINE V3 Turn(const std::array<Lanes, 9>& rotation, size_t i, const V3& v) {
  const auto row = [&](size_t k) HWY_ATTR {
    return Load3(rotation[k].data() + i, rotation[k + 1].data() + i, rotation[k + 2].data() + i);
  };
  return {Dot(row(0), v), Dot(row(3), v), Dot(row(6), v)};
}

void DescribeKernel(const SurfaceLanes& met, std::span<const SampleLanes> samples,
                    float sample_angle, const Light& light, float blotch_side, DescribedLanes* out,
                    SightLanes* sight) {
  const D d;
  for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const V b = hn::Load(d, met.b.data() + i);
    const V c = hn::Load(d, met.c.data() + i);
    const V a = hn::Sub(Constant(1), hn::Add(b, c));
    const Corner va = LoadCorner(met.vertices[0].data() + i);
    const Corner vb = LoadCorner(met.vertices[1].data() + i);
    const Corner vc = LoadCorner(met.vertices[2].data() + i);
    const auto blend = [&](V at_a, V at_b, V at_c) HWY_ATTR {
      return hn::MulAdd(a, at_a, hn::MulAdd(b, at_b, hn::Mul(c, at_c)));
    };
    const V range = hn::Load(d, met.range.data() + i);
    const V3 direction = Load3(samples[0].direction, i);
    const V3 way = range * direction;
    const V3 plane = Unit(Load3(met.geometric_normal, i));
    hn::Store(range, d, sight->range.data() + i);
    Store3(way, &sight->way, i);
    Store3(plane, &sight->geometric_normal, i);

    V3 normal{blend(va.normal.x, vb.normal.x, vc.normal.x),
              blend(va.normal.y, vb.normal.y, vc.normal.y),
              blend(va.normal.z, vb.normal.z, vc.normal.z)};
    if (met.any_turned) normal = Turn(met.rotation, i, normal);
    normal = Unit(normal);
    const V facing = Dot(normal, direction);
    const V cosine = hn::Abs(facing);
    const V side = hn::CopySign(Constant(1), hn::Neg(facing));
    normal = side * normal;
    Store3(normal, &out->normal, i);
    hn::Store(cosine, d, out->cosine.data() + i);
    Store3(MulAdd3(hn::Add(cosine, cosine), normal, direction), &out->mirrored, i);
    hn::Store(hn::Mul(blend(va.openness, vb.openness, vc.openness),
                      hn::Mul(hn::Load(d, met.openness.data() + i), Constant(1.0F / 255))),
              d, out->openness.data() + i);
    const V3 tint{blend(va.tint.x, vb.tint.x, vc.tint.x), blend(va.tint.y, vb.tint.y, vc.tint.y),
                  blend(va.tint.z, vb.tint.z, vc.tint.z)};
    Store3(Constant(1.0F / (255 * 255)) * Product(Product(tint, tint), Load3(met.paint, i)),
           &out->tone, i);

    const V sun_cosine = Dot(normal, Constant3(light.to_sun));
    const auto is_leaf =
        hn::RebindMask(d, hn::Eq(hn::Load(DI(), met.finish.data() + i), hn::Set(DI(), kFoliage)));
    const V through_leaf = hn::Add(Constant(0.25F), hn::Max(hn::Mul(sun_cosine, Constant(0.55F)),
                                                            hn::Mul(sun_cosine, Constant(-0.45F))));
    hn::Store(hn::IfThenElse(is_leaf, through_leaf, hn::Max(sun_cosine, Constant(0))), d,
              sight->sun_cosine.data() + i);

    // A tilted surface stretches the footprint in one direction by 1/cos; the geometric mean of
    // both directions is used.
    const V footprint =
        hn::Div(hn::Mul(range, Constant(sample_angle)), hn::Sqrt(hn::Max(cosine, Constant(0.04F))));
    const V level = FastLog2(
        hn::Max(hn::Mul(footprint, hn::Load(d, met.texels_per_metre.data() + i)), Constant(1e-6F)));
    const V u = blend(va.u, vb.u, vc.u);
    const V v = blend(va.v, vb.v, vc.v);
    if (met.any_blotches) {
      const V scale = hn::Load(d, met.blotch_scale.data() + i);
      hn::Store(hn::Mul(u, scale), d, out->blotch.u.data() + i);
      hn::Store(hn::Mul(v, scale), d, out->blotch.v.data() + i);
      const V texels = hn::Mul(footprint, Constant(blotch_side / kBlotchMetres));
      hn::Store(hn::Add(Constant(1), FastLog2(hn::Max(texels, Constant(1e-6F)))), d,
                out->blotch.level.data() + i);
    }
    const auto store_place = [&](size_t sample, V at_u, V at_v) HWY_ATTR {
      DescribedLanes::Place& place = out->samples[sample];
      hn::Store(at_u, d, place.u.data() + i);
      hn::Store(at_v, d, place.v.data() + i);
      hn::Store(hn::Add(level, hn::Load(d, samples[sample].level_offset.data() + i)), d,
                place.level.data() + i);
    };
    store_place(0, u, v);
    if (samples.size() == 1) continue;

    // The barycentric weights grow along the dual basis of the triangle's sides.
    const V3 corner = LoadPosition(met.positions[0].data() + i);
    const V3 ab = LoadPosition(met.positions[1].data() + i) - corner;
    const V3 ac = LoadPosition(met.positions[2].data() + i) - corner;
    const V3 across = Cross(ab, ac);
    const V scale = hn::Div(Constant(1), Dot(across, across));
    const V3 grows_b = scale * Cross(ac, across);
    const V3 grows_c = scale * Cross(across, ab);
    V3 grows_u = MulAdd3(hn::Sub(vb.u, va.u), grows_b, hn::Sub(vc.u, va.u) * grows_c);
    V3 grows_v = MulAdd3(hn::Sub(vb.v, va.v), grows_b, hn::Sub(vc.v, va.v) * grows_c);
    if (met.any_turned) {
      grows_u = Turn(met.rotation, i, grows_u);
      grows_v = Turn(met.rotation, i, grows_v);
    }
    const V height = Dot(plane, way);
    for (size_t sample = 1; sample < samples.size(); ++sample) {
      const V3 towards = Load3(samples[sample].direction, i);
      const V on_plane = hn::Div(height, Dot(plane, towards));
      // The plane of a curved surface may be met elsewhere, or nowhere.
      const auto is_near = hn::And(hn::Gt(on_plane, hn::Mul(range, Constant(0.5F))),
                                   hn::Lt(on_plane, hn::Mul(range, Constant(2))));
      const V3 step = hn::IfThenElse(is_near, on_plane, range) * towards - way;
      store_place(sample, hn::Add(u, Dot(grows_u, step)), hn::Add(v, Dot(grows_v, step)));
    }
  }
}

void IlluminateKernel(const SurfaceLanes& met, const DescribedLanes& described,
                      const Lanes3& albedo, const Lanes3& blotches, const Lanes3& reflected,
                      const Light& light, const Vector3f& sky_mean, SightLanes* sight) {
  const D d;
  const DI di;
  for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    V3 colour = Product(Load3(albedo, i), Load3(described.tone, i));
    if (met.any_blotches) {
      const V half = Constant(0.5F);
      const V red = hn::Sub(hn::Load(d, blotches.x.data() + i), half);
      const V green = hn::Sub(hn::Load(d, blotches.y.data() + i), half);
      const V both = hn::MulAdd(Constant(1.6F), red, hn::Mul(Constant(0.8F), green));
      colour = hn::MulAdd(hn::Load(d, met.blotches.data() + i), both, Constant(1)) * colour;
    }
    const V openness = hn::Load(d, described.openness.data() + i);
    const V up =
        hn::MulAdd(Constant(0.5F), hn::Load(d, described.normal.z.data() + i), Constant(0.5F));
    const V from_sky = hn::Mul(openness, up);
    const V from_ground =
        hn::MulAdd(hn::Sub(Constant(1), openness), Constant(0.9F), hn::Sub(openness, from_sky));
    const V3 ambient =
        MulAdd3(from_sky, Constant3(sky_mean), from_ground * Constant3(light.ground));
    V3 shade = Product(colour, ambient);
    V glow = Constant(0.7F);  // of lamps, beyond what they reflect
    if (met.any_baked) {
      // The irradiance of a lamp's own faces is what it emits.
      const auto is_baked = hn::Gt(hn::Load(d, met.is_baked.data() + i), Constant(0.5F));
      const V3 baked = Product(colour, Load3(met.irradiance, i));
      shade = {hn::IfThenElse(is_baked, baked.x, shade.x),
               hn::IfThenElse(is_baked, baked.y, shade.y),
               hn::IfThenElse(is_baked, baked.z, shade.z)};
      glow = hn::IfThenElse(is_baked, Constant(0), glow);
    }
    V3 sun = hn::Load(d, sight->sun_cosine.data() + i) * Product(colour, Constant3(light.sun));
    const VI finish = hn::Load(di, met.finish.data() + i);
    const auto is = [&](int32_t kind) HWY_ATTR {
      const auto same = hn::Eq(finish, hn::Set(di, kind));
      return hn::RebindMask(d, same);
    };
    shade = MulAdd3(hn::IfThenElseZero(is(kLamp), glow), colour, shade);
    if (met.any_mirror) {
      const auto is_glass = is(kGlass);
      const auto is_mirror = hn::Or(is_glass, is(kPaint));
      const V base = hn::IfThenElse(is_glass, Constant(0.10F), Constant(0.04F));
      const V x =
          hn::Max(hn::Sub(Constant(1), hn::Load(d, described.cosine.data() + i)), Constant(0));
      const V x2 = hn::Mul(x, x);
      // Schlick 1994
      const V fresnel = hn::IfThenElseZero(
          is_mirror, hn::MulAdd(hn::Sub(Constant(1), base), hn::Mul(hn::Mul(x2, x2), x), base));
      const V kept = hn::Mul(hn::Sub(Constant(1), fresnel),
                             hn::IfThenElse(is_glass, Constant(0.55F), Constant(1)));
      shade = MulAdd3(kept, shade, fresnel * Load3(reflected, i));
      sun = kept * sun;
    }
    const V clear =
        hn::Exp(d, hn::Mul(hn::Load(d, sight->range.data() + i), Constant(-1 / light.haze)));
    const V3 haze = hn::Sub(Constant(1), clear) * Constant3(light.horizon);
    Store3(MulAdd3(clear, shade, haze), &sight->shade, i);
    Store3(clear * sun, &sight->sun, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::town
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::town {

HWY_EXPORT(DescribeKernel);
HWY_EXPORT(IlluminateKernel);

void Describe(const SurfaceLanes& met, std::span<const SampleLanes> samples, float sample_angle,
              const Light& light, float blotch_side, DescribedLanes* described, SightLanes* sight) {
  HWY_DYNAMIC_DISPATCH(DescribeKernel)
  (met, samples, sample_angle, light, blotch_side, described, sight);
}

void Illuminate(const SurfaceLanes& met, const DescribedLanes& described, const Lanes3& albedo,
                const Lanes3& blotches, const Lanes3& reflected, const Light& light,
                const Vector3f& sky_mean, SightLanes* sight) {
  HWY_DYNAMIC_DISPATCH(IlluminateKernel)
  (met, described, albedo, blotches, reflected, light, sky_mean, sight);
}

}  // namespace orb360::town
#endif
