#include "slam/features/blur.h"

#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/features/blur.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// exp(-x^2 / 8) for x = 0..3, scaled so that the sum of all seven weights is 256.
constexpr int kReach = 3;
constexpr uint16_t kWeights[kReach + 1] = {54, 49, 34, 18};

// out[x] = sum over i of weight[|i|] * in[x + i * step].
void BlurAlong(const uint8_t* in, ptrdiff_t step, int count, uint8_t* out) {
  const hn::ScalableTag<uint16_t> d;
  const hn::Rebind<uint8_t, decltype(d)> d8;
  const hn::RebindToSigned<decltype(d)> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto load = [&](int i)
                          HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(d8, in + x + i * step)); };
    // The sum is at most 255 * 256 + 128, which fits into an unsigned 16-bit number.
    auto sum = hn::Add(hn::Mul(load(0), hn::Set(d, kWeights[0])), hn::Set(d, 128));
    for (int i = 1; i <= kReach; ++i) {
      sum = hn::Add(sum, hn::Mul(hn::Add(load(i), load(-i)), hn::Set(d, kWeights[i])));
    }
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, hn::ShiftRight<8>(sum))), d8, out + x);
  }
  for (; x < count; ++x) {
    int sum = kWeights[0] * in[x] + 128;
    for (int i = 1; i <= kReach; ++i) sum += kWeights[i] * (in[x + i * step] + in[x - i * step]);
    out[x] = static_cast<uint8_t>(sum >> 8);
  }
}

void BlurImage(const uint8_t* from, ptrdiff_t from_stride, int width, int height, uint8_t* to,
               ptrdiff_t to_stride) {
  std::vector<uint8_t> row(width + 2 * kReach);
  for (int y = 0; y < height; ++y) {
    BlurAlong(from + y * from_stride - kReach, from_stride, width + 2 * kReach, row.data());
    BlurAlong(row.data() + kReach, 1, width, to + y * to_stride);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(BlurImage);

void BlurImage(const uint8_t* from, ptrdiff_t from_stride, int width, int height, uint8_t* to,
               ptrdiff_t to_stride) {
  HWY_DYNAMIC_DISPATCH(BlurImage)(from, from_stride, width, height, to, to_stride);
}

}  // namespace orb360
#endif
