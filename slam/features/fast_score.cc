#include "slam/features/fast_score.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/features/fast_score.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// a >= b. Highway 1.0.3 compares 8-bit lanes only for equality, and orders only signed ones.
template <class V>
HWY_INLINE auto NotLess(V a, V b) {
  return hn::Eq(hn::Max(a, b), a);
}

// The maximum, over all arcs of 9 neighbours on the circle, of the minimum within the arc. The arcs
// from k and k + 1 have 8 neighbours in common, so the better of both is min(common, max(first,
// last)) for every second k. The minima of 2, 4 and 8 neighbours are computed by doubling. This
// takes 47 instructions.
template <class V, class Smaller, class Larger>
HWY_INLINE V BestArc(const V (&c)[16], Smaller smaller, Larger larger) {
  V two[8];
  V four[8];
  for (int i = 0; i < 8; ++i) two[i] = smaller(c[2 * i + 1], c[(2 * i + 2) & 15]);
  for (int i = 0; i < 8; ++i) four[i] = smaller(two[i], two[(i + 1) & 7]);
  const auto pair_of_arcs = [&](int i) HWY_ATTR {
    const V eight = smaller(four[i], four[(i + 2) & 7]);
    return smaller(eight, larger(c[2 * i], c[(2 * i + 9) & 15]));
  };
  V best = pair_of_arcs(0);
  for (int i = 1; i < 8; ++i) best = larger(best, pair_of_arcs(i));
  return best;
}

template <class D>
HWY_INLINE void ScoreBlock(D d, const uint8_t* center, const ptrdiff_t (&circle)[16],
                           uint8_t min_score, uint8_t* score) {
  using V = hn::Vec<D>;
  const auto min = [](V a, V b) HWY_ATTR { return hn::Min(a, b); };
  const auto max = [](V a, V b) HWY_ATTR { return hn::Max(a, b); };
  const V p = hn::LoadU(d, center);
  const V threshold = hn::Set(d, min_score);
  V c[16];
  // Every arc of 9 contains two neighbours among the four compass points. Many blocks are rejected
  // here.
  for (int i = 0; i < 16; i += 4) c[i] = hn::LoadU(d, center + circle[i]);
  const V brighter = hn::Min(hn::Max(c[0], c[8]), hn::Max(c[4], c[12]));
  const V darker = hn::Max(hn::Min(c[0], c[8]), hn::Min(c[4], c[12]));
  const V possible = hn::Max(hn::SaturatedSub(brighter, p), hn::SaturatedSub(p, darker));
  if (hn::AllFalse(d, NotLess(possible, threshold))) {
    hn::StoreU(hn::Zero(d), d, score);
    return;
  }
  for (int i = 0; i < 16; ++i) {
    if (i % 4 != 0) c[i] = hn::LoadU(d, center + circle[i]);
  }
  const V best =
      hn::Max(hn::SaturatedSub(BestArc(c, min, max), p), hn::SaturatedSub(p, BestArc(c, max, min)));
  hn::StoreU(hn::IfThenElseZero(NotLess(best, threshold), best), d, score);
}

void FastScoreRow(const uint8_t* center, ptrdiff_t stride, int width, uint8_t min_score,
                  uint8_t* score) {
  // Offsets of the circle of radius 3, clockwise from the top.
  const ptrdiff_t circle[16] = {-3 * stride, -3 * stride + 1, -2 * stride + 2, -stride + 3,
                                3,           stride + 3,      2 * stride + 2,  3 * stride + 1,
                                3 * stride,  3 * stride - 1,  2 * stride - 2,  stride - 3,
                                -3,          -stride - 3,     -2 * stride - 2, -3 * stride - 1};
  const hn::ScalableTag<uint8_t> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) ScoreBlock(d, center + x, circle, min_score, score + x);
  if (x < width && width >= lanes) {  // the last block overlaps the one before
    ScoreBlock(d, center + width - lanes, circle, min_score, score + width - lanes);
    return;
  }
  const hn::CappedTag<uint8_t, 1> d1;
  for (; x < width; ++x) ScoreBlock(d1, center + x, circle, min_score, score + x);
}

void FastMaximaRow(const uint8_t* above, const uint8_t* middle, const uint8_t* below, int width,
                   uint8_t min_score, std::vector<int>* columns) {
  const auto is_maximum = [&](int x) {
    const uint8_t s = middle[x];
    return s >= min_score && s > above[x - 1] && s > above[x] && s > above[x + 1] &&
           s > middle[x - 1] && s >= middle[x + 1] && s >= below[x - 1] && s >= below[x] &&
           s >= below[x + 1];
  };
  const hn::ScalableTag<uint8_t> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto threshold = hn::Set(d, min_score);
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto s = hn::LoadU(d, middle + x);
    const auto enough = NotLess(s, threshold);
    if (hn::AllFalse(d, enough)) continue;
    const auto earlier =
        hn::Max(hn::Max(hn::LoadU(d, above + x - 1), hn::LoadU(d, above + x)),
                hn::Max(hn::LoadU(d, above + x + 1), hn::LoadU(d, middle + x - 1)));
    const auto later = hn::Max(hn::Max(hn::LoadU(d, below + x - 1), hn::LoadU(d, below + x)),
                               hn::Max(hn::LoadU(d, below + x + 1), hn::LoadU(d, middle + x + 1)));
    const auto maximum = hn::AndNot(NotLess(earlier, s), hn::And(enough, NotLess(s, later)));
    if (hn::AllFalse(d, maximum)) continue;
    uint8_t bits[HWY_MAX_BYTES / 8 + 8] = {};
    const size_t bytes = hn::StoreMaskBits(d, maximum, bits);
    for (size_t b = 0; b < bytes; ++b) {
      for (unsigned mask = bits[b]; mask != 0; mask &= mask - 1) {
        columns->push_back(x + static_cast<int>(8 * b) + __builtin_ctz(mask));
      }
    }
  }
  for (; x < width; ++x) {
    if (is_maximum(x)) columns->push_back(x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(FastScoreRow);
HWY_EXPORT(FastMaximaRow);

void FastScoreRow(const uint8_t* center, ptrdiff_t stride, int width, uint8_t min_score,
                  uint8_t* score) {
  HWY_DYNAMIC_DISPATCH(FastScoreRow)(center, stride, width, min_score, score);
}

void FastMaximaRow(const uint8_t* above, const uint8_t* middle, const uint8_t* below, int width,
                   uint8_t min_score, std::vector<int>* columns) {
  HWY_DYNAMIC_DISPATCH(FastMaximaRow)(above, middle, below, width, min_score, columns);
}

}  // namespace orb360
#endif
