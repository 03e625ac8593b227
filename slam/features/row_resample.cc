#include "slam/features/row_resample.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/features/row_resample.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count,
               uint16_t* blended) {
  const hn::ScalableTag<uint16_t> d;
  const hn::Rebind<uint8_t, decltype(d)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto second = hn::Set(d, static_cast<uint16_t>(weight));
  const auto first = hn::Set(d, static_cast<uint16_t>(ResampleTaps::kWeightOne - weight));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto a = hn::PromoteTo(d, hn::LoadU(d8, upper + x));
    const auto b = hn::PromoteTo(d, hn::LoadU(d8, lower + x));
    hn::StoreU(hn::Add(hn::Mul(a, first), hn::Mul(b, second)), d, blended + x);
  }
  for (; x < count; ++x) {
    blended[x] =
        static_cast<uint16_t>(upper[x] * (ResampleTaps::kWeightOne - weight) + lower[x] * weight);
  }
}

void ResampleRow(const uint16_t* blended, const ResampleTaps& taps, uint8_t* out) {
  constexpr int kShift = 2 * ResampleTaps::kWeightBits;
  const hn::CappedTag<int32_t, 16> d;
  const hn::Rebind<uint8_t, decltype(d)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int count = static_cast<int>(taps.index.size());
  const auto one = hn::Set(d, ResampleTaps::kWeightOne);
  const auto half = hn::Set(d, 1 << (kShift - 1));
  const auto low = hn::Set(d, 0xFFFF);
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    // Both neighbours in one 32-bit word (little endian: the first is the low half).
    const auto offsets = hn::ShiftLeft<1>(hn::LoadU(d, taps.index.data() + x));
    const auto pair = hn::GatherOffset(d, reinterpret_cast<const int32_t*>(blended), offsets);
    const auto weight = hn::LoadU(d, taps.weight.data() + x);
    const auto first = hn::Mul(hn::And(pair, low), hn::Sub(one, weight));
    const auto second = hn::Mul(hn::ShiftRight<16>(pair), weight);
    const auto sum = hn::ShiftRight<kShift>(hn::Add(hn::Add(first, second), half));
    hn::StoreU(hn::DemoteTo(d8, sum), d8, out + x);
  }
  for (; x < count; ++x) {
    const uint16_t* pair = blended + taps.index[x];
    const int sum = pair[0] * (ResampleTaps::kWeightOne - taps.weight[x]) +
                    pair[1] * taps.weight[x] + (1 << (kShift - 1));
    out[x] = static_cast<uint8_t>(sum >> kShift);
  }
}

void HalveRows(const uint8_t* upper, const uint8_t* lower, int count, uint8_t* out) {
  int x = 0;
#if HWY_TARGET != HWY_SCALAR  // whose vectors of one lane cannot hold a pair
  const hn::ScalableTag<uint16_t> d;
  const hn::Repartition<uint8_t, decltype(d)> d8;
  const hn::Rebind<uint8_t, decltype(d)> d8half;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto low = hn::Set(d, 0x00FF);
  const auto sum_of_pairs = [&](const uint8_t* row) HWY_ATTR {
    const auto pairs = hn::BitCast(d, hn::LoadU(d8, row));
    return hn::Add(hn::And(pairs, low), hn::ShiftRight<8>(pairs));
  };
  for (; x + lanes <= count; x += lanes) {
    const auto sum = hn::Add(sum_of_pairs(upper + 2 * x), sum_of_pairs(lower + 2 * x));
    const auto mean = hn::ShiftRight<2>(hn::Add(sum, hn::Set(d, 2)));
    const hn::RebindToSigned<decltype(d)> di;
    hn::StoreU(hn::DemoteTo(d8half, hn::BitCast(di, mean)), d8half, out + x);
  }
#endif
  for (; x < count; ++x) {
    const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
    out[x] = static_cast<uint8_t>((sum + 2) >> 2);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(BlendRows);
HWY_EXPORT(ResampleRow);
HWY_EXPORT(HalveRows);

ResampleTaps::ResampleTaps(int source_size, int target_size)
    : index(target_size), weight(target_size) {
  for (int i = 0; i < target_size; ++i) {
    // (i + 1/2) * source / target - 1/2, as a fraction over 2 * target.
    const int64_t numerator = (int64_t{2} * i + 1) * source_size - target_size;
    const int64_t denominator = int64_t{2} * target_size;
    const int64_t whole = numerator >= 0 ? numerator / denominator : -1;
    const int64_t remainder = numerator - whole * denominator;
    index[i] = static_cast<int32_t>(whole);
    weight[i] = static_cast<int32_t>((remainder * kWeightOne + target_size) / denominator);
  }
}

void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count,
               uint16_t* blended) {
  HWY_DYNAMIC_DISPATCH(BlendRows)(upper, lower, weight, count, blended);
}

void ResampleRow(const uint16_t* blended, const ResampleTaps& taps, uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(ResampleRow)(blended, taps, out);
}

void HalveRows(const uint8_t* upper, const uint8_t* lower, int count, uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(HalveRows)(upper, lower, count, out);
}

}  // namespace orb360
#endif
