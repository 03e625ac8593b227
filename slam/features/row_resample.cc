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

// (kWeightOne - weight) * first + weight * second, rounded and divided by kWeightOne.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V Blend(D d, V first, V second, V weight) {
  const V rest = hn::Sub(hn::Set(d, ResampleTaps::kWeightOne), weight);
  const V sum = hn::Add(hn::Mul(first, rest), hn::Mul(second, weight));
  return hn::ShiftRight<ResampleTaps::kWeightBits>(
      hn::Add(sum, hn::Set(d, ResampleTaps::kWeightOne / 2)));
}

HWY_INLINE uint8_t Blend(int first, int second, int weight) {
  const int sum = first * (ResampleTaps::kWeightOne - weight) + second * weight;
  return static_cast<uint8_t>((sum + ResampleTaps::kWeightOne / 2) >> ResampleTaps::kWeightBits);
}

void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count,
               uint8_t* blended) {
  const hn::ScalableTag<uint16_t> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<uint8_t, decltype(d)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto weights = hn::Set(d, static_cast<uint16_t>(weight));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto a = hn::PromoteTo(d, hn::LoadU(d8, upper + x));
    const auto b = hn::PromoteTo(d, hn::LoadU(d8, lower + x));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, Blend(d, a, b, weights))), d8, blended + x);
  }
  for (; x < count; ++x) blended[x] = Blend(upper[x], lower[x], weight);
}

void ResampleRow(const uint8_t* row, const ResampleTaps& taps, uint8_t* out) {
  const int count = taps.size();
  int x = 0;
#if HWY_TARGET != HWY_SCALAR  // which has no vectors of 16 bytes
  const hn::Full128<uint8_t> d8;
  const hn::Full128<uint16_t> d16;
  const hn::Full128<int16_t> di16;
  const hn::Rebind<uint8_t, decltype(d16)> d8half;
  const auto low = hn::Set(d16, 0xFF);
  const int num_fast = taps.lookup.empty() ? 0 : count - count % 8;
  for (; x < num_fast; x += 8) {
    const auto source = hn::LoadU(d8, row + taps.index[x]);
    // Both samples of a pixel are in one 16-bit word (little endian: the first one is the low
    // half).
    const auto pairs = hn::BitCast(
        d16, hn::TableLookupBytes(source, hn::LoadU(d8, taps.lookup.data() + ptrdiff_t{2} * x)));
    const auto blended = Blend(d16, hn::And(pairs, low), hn::ShiftRight<8>(pairs),
                               hn::LoadU(d16, taps.weight.data() + x));
    hn::StoreU(hn::DemoteTo(d8half, hn::BitCast(di16, blended)), d8half, out + x);
  }
#endif
  for (; x < count; ++x) {
    const uint8_t* pair = row + taps.index[x];
    out[x] = Blend(pair[0], pair[1], taps.weight[x]);
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

ResampleTaps::ResampleTaps(int source, int target)
    : source_size(source), index(target), weight(target) {
  for (int i = 0; i < target; ++i) {
    // (i + 1/2) * source / target - 1/2 as a fraction over 2 * target.
    const int64_t numerator = (int64_t{2} * i + 1) * source - target;
    const int64_t denominator = int64_t{2} * target;
    const int64_t whole = numerator >= 0 ? numerator / denominator : -1;
    const int64_t remainder = numerator - whole * denominator;
    index[i] = static_cast<int32_t>(whole);
    weight[i] = static_cast<uint16_t>((remainder * kWeightOne + target) / denominator);
  }
  const auto place = [&](int i) { return index[i] - index[i - i % 8]; };
  for (int i = 0; i < target; ++i) {
    if (place(i) + 1 > kResampleReach) {
      lookup.clear();
      return;
    }
    lookup.push_back(static_cast<uint8_t>(place(i)));
    lookup.push_back(static_cast<uint8_t>(place(i) + 1));
  }
}

void BlendRows(const uint8_t* upper, const uint8_t* lower, int weight, int count,
               uint8_t* blended) {
  HWY_DYNAMIC_DISPATCH(BlendRows)(upper, lower, weight, count, blended);
}

void ResampleRow(const uint8_t* row, const ResampleTaps& taps, uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(ResampleRow)(row, taps, out);
}

void HalveRows(const uint8_t* upper, const uint8_t* lower, int count, uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(HalveRows)(upper, lower, count, out);
}

}  // namespace orb360
#endif
