// Per-target include guard: foreach_target includes this file once for each instruction set.
#if defined(ORB360_SLAM_STEREO_BYTE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_SLAM_STEREO_BYTE_LANES_INL_H_
#undef ORB360_SLAM_STEREO_BYTE_LANES_INL_H_
#else
#define ORB360_SLAM_STEREO_BYTE_LANES_INL_H_
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include <hwy/highway.h>

// Sixteen bytes, one for each of sixteen hypotheses of a pixel, on every instruction set.
HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr int kByteLanes = 16;

#if HWY_TARGET == HWY_SCALAR  // which has no vectors of 16 bytes

struct Bytes {
  std::array<uint8_t, kByteLanes> lane;
};

template <class F>
HWY_INLINE Bytes ForEachLane(F f) {
  Bytes result;
  for (int i = 0; i < kByteLanes; ++i) result.lane[i] = static_cast<uint8_t>(f(i));
  return result;
}

HWY_INLINE Bytes LoadBytes(const uint8_t* from) {
  return ForEachLane([&](int i) { return from[i]; });
}
HWY_INLINE void StoreBytes(const Bytes& a, uint8_t* to) { std::ranges::copy(a.lane, to); }
HWY_INLINE Bytes SetBytes(int value) {
  return ForEachLane([&](int) { return value; });
}
HWY_INLINE Bytes Plus(const Bytes& a, const Bytes& b) {
  return ForEachLane([&](int i) { return std::min(a.lane[i] + b.lane[i], 255); });
}
HWY_INLINE Bytes Minus(const Bytes& a, const Bytes& b) {
  return ForEachLane([&](int i) { return a.lane[i] - b.lane[i]; });
}
HWY_INLINE Bytes Least(const Bytes& a, const Bytes& b) {
  return ForEachLane([&](int i) { return std::min(a.lane[i], b.lane[i]); });
}
HWY_INLINE Bytes Most(const Bytes& a, const Bytes& b) {
  return ForEachLane([&](int i) { return std::max(a.lane[i], b.lane[i]); });
}
HWY_INLINE Bytes DifferingBits(const Bytes& a, const Bytes& b) {
  return ForEachLane(
      [&](int i) { return std::popcount(static_cast<uint8_t>(a.lane[i] ^ b.lane[i])); });
}
/// The lanes of (below, a) one up: the last lane of `below` becomes the first one.
HWY_INLINE Bytes FromLaneBelow(const Bytes& a, const Bytes& below) {
  return ForEachLane([&](int i) { return i > 0 ? a.lane[i - 1] : below.lane[kByteLanes - 1]; });
}
/// The lanes of (a, above) one down: the first lane of `above` becomes the last one.
HWY_INLINE Bytes FromLaneAbove(const Bytes& a, const Bytes& above) {
  return ForEachLane([&](int i) { return i + 1 < kByteLanes ? a.lane[i + 1] : above.lane[0]; });
}
/// The least lane, in all lanes.
HWY_INLINE Bytes LeastOfLanes(const Bytes& a) {
  return SetBytes(*std::ranges::min_element(a.lane));
}
HWY_INLINE int FirstLane(const Bytes& a) { return a.lane[0]; }
/// The first lane in which both are equal, or -1.
HWY_INLINE int FirstEqual(const Bytes& a, const Bytes& b) {
  for (int i = 0; i < kByteLanes; ++i) {
    if (a.lane[i] == b.lane[i]) return i;
  }
  return -1;
}
/// Sets the elements of `to` to `value` where a < b.
HWY_INLINE void SetWhereLess(const Bytes& a, const Bytes& b, int16_t value, int16_t* to) {
  for (int i = 0; i < kByteLanes; ++i) to[i] = a.lane[i] < b.lane[i] ? value : to[i];
}

#else

using ByteTag = hn::Full128<uint8_t>;
using Bytes = hn::Vec<ByteTag>;

HWY_INLINE Bytes LoadBytes(const uint8_t* from) { return hn::LoadU(ByteTag(), from); }
HWY_INLINE void StoreBytes(Bytes a, uint8_t* to) { hn::StoreU(a, ByteTag(), to); }
HWY_INLINE Bytes SetBytes(int value) { return hn::Set(ByteTag(), static_cast<uint8_t>(value)); }
HWY_INLINE Bytes Plus(Bytes a, Bytes b) { return hn::SaturatedAdd(a, b); }
HWY_INLINE Bytes Minus(Bytes a, Bytes b) { return hn::Sub(a, b); }
HWY_INLINE Bytes Least(Bytes a, Bytes b) { return hn::Min(a, b); }
HWY_INLINE Bytes Most(Bytes a, Bytes b) { return hn::Max(a, b); }
HWY_INLINE Bytes DifferingBits(Bytes a, Bytes b) { return hn::PopulationCount(hn::Xor(a, b)); }
/// The lanes of (below, a) one up: the last lane of `below` becomes the first one.
HWY_INLINE Bytes FromLaneBelow(Bytes a, Bytes below) {
  return hn::CombineShiftRightBytes<15>(ByteTag(), a, below);
}
/// The lanes of (a, above) one down: the first lane of `above` becomes the last one.
HWY_INLINE Bytes FromLaneAbove(Bytes a, Bytes above) {
  return hn::CombineShiftRightBytes<1>(ByteTag(), above, a);
}
/// The least lane, in all lanes.
HWY_INLINE Bytes LeastOfLanes(Bytes a) {
  const ByteTag d;
  a = hn::Min(a, hn::CombineShiftRightBytes<8>(d, a, a));
  a = hn::Min(a, hn::CombineShiftRightBytes<4>(d, a, a));
  a = hn::Min(a, hn::CombineShiftRightBytes<2>(d, a, a));
  return hn::Min(a, hn::CombineShiftRightBytes<1>(d, a, a));
}
HWY_INLINE int FirstLane(Bytes a) { return hn::GetLane(a); }
/// The first lane in which both are equal, or -1.
HWY_INLINE int FirstEqual(Bytes a, Bytes b) {
  return static_cast<int>(hn::FindFirstTrue(ByteTag(), hn::Eq(a, b)));
}
/// Sets the elements of `to` to `value` where a < b.
HWY_INLINE void SetWhereLess(Bytes a, Bytes b, int16_t value, int16_t* to) {
  const hn::Full128<int16_t> d;
  const Bytes mask = hn::VecFromMask(ByteTag(), hn::Lt(a, b));
  const auto values = hn::Set(d, value);
  const auto low = hn::MaskFromVec(hn::BitCast(d, hn::InterleaveLower(ByteTag(), mask, mask)));
  const auto high = hn::MaskFromVec(hn::BitCast(d, hn::InterleaveUpper(ByteTag(), mask, mask)));
  hn::StoreU(hn::IfThenElse(low, values, hn::LoadU(d, to)), d, to);
  hn::StoreU(hn::IfThenElse(high, values, hn::LoadU(d, to + 8)), d, to + 8);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#endif
