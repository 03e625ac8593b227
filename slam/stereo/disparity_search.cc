#include "slam/stereo/disparity_search.h"

#include <cstdlib>
#include <memory>
#include <vector>

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/disparity_search.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "slam/stereo/byte_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {

// The costs of all hypotheses of a pixel.
template <int kVectors>
struct HypothesisCosts {
  Bytes vectors[kVectors];  // an array, since vectors cannot be elements of every container

  // An implicit constructor is not compiled for the target, as Arm's vectors require.
  HWY_INLINE HypothesisCosts() {}

  static HWY_INLINE HypothesisCosts Load(const uint8_t* from) {
    HypothesisCosts costs;
    for (int i = 0; i < kVectors; ++i) costs.vectors[i] = LoadBytes(from + i * kByteLanes);
    return costs;
  }
  HWY_INLINE void Store(uint8_t* to) const {
    for (int i = 0; i < kVectors; ++i) StoreBytes(vectors[i], to + i * kByteLanes);
  }
  HWY_INLINE void AddTo(uint8_t* to) const {
    for (int i = 0; i < kVectors; ++i) {
      StoreBytes(Plus(vectors[i], LoadBytes(to + i * kByteLanes)), to + i * kByteLanes);
    }
  }
  HWY_INLINE Bytes LeastInAllLanes() const {
    Bytes least = vectors[0];
    for (int i = 1; i < kVectors; ++i) least = Least(least, vectors[i]);
    return LeastOfLanes(least);
  }
};

// Aggregated costs along a path, less their least.
template <int kVectors>
struct PathCosts {
  HypothesisCosts<kVectors> costs;

  // Goes on to the next pixel, whose matching costs are given, and returns its aggregated costs.
  HWY_INLINE HypothesisCosts<kVectors> Advance(const HypothesisCosts<kVectors>& matching,
                                               Bytes small_penalty, Bytes large_penalty) {
    const Bytes beyond = SetBytes(255);
    HypothesisCosts<kVectors> next;
    for (int i = 0; i < kVectors; ++i) {
      const Bytes here = costs.vectors[i];
      const Bytes below = FromLaneBelow(here, i > 0 ? costs.vectors[i - 1] : beyond);
      const Bytes above = FromLaneAbove(here, i + 1 < kVectors ? costs.vectors[i + 1] : beyond);
      const Bytes beside = Plus(Least(below, above), small_penalty);
      next.vectors[i] = Plus(matching.vectors[i], Least(Least(here, beside), large_penalty));
    }
    const Bytes least = next.LeastInAllLanes();
    for (int i = 0; i < kVectors; ++i) costs.vectors[i] = Minus(next.vectors[i], least);
    return next;
  }
};

// The search of one level, row by row. `kFirst` is the first disparity.
template <int kVectors, int kFirst>
class DisparitySearch {
 public:
  static constexpr int kCount = kVectors * kByteLanes;

  DisparitySearch(const CensusImage& first, const CensusImage& second,
                  const DisparityPenalties& penalties)
      : first_(first),
        second_(second),
        penalties_(penalties),
        matching_(std::make_unique_for_overwrite<uint8_t[]>(At(0, first.height))),
        sums_(std::make_unique_for_overwrite<uint8_t[]>(At(0, first.height))),
        least_of_second_(first.width + kBefore + kCount),
        first_of_second_(first.width + kBefore + kCount) {}

  FoundDisparities Run() {
    const cv::Size size(first_.width, first_.height);
    FoundDisparities found{cv::Mat(size, CV_32F), cv::Mat(size, CV_8U), cv::Mat(size, CV_32F),
                           cv::Mat(size, CV_8U)};
    std::vector<uint8_t> paths(At(0, 1), 0);
    for (int i = -kPathLead; i < first_.height; ++i) {
      const int y = i < 0 ? i + first_.height : i;
      if (i < 0 || i < first_.height - kPathLead) Match(y);
      if (i >= 0) AggregateRow(y);
      AdvanceColumns(y, i >= 0, paths.data());
    }
    std::fill(paths.begin(), paths.end(), 0);
    for (int i = -kPathLead; i < first_.height; ++i) {
      const int y = first_.height - 1 - (i < 0 ? i + first_.height : i);
      AdvanceColumns(y, i >= 0, paths.data());
      if (i >= 0) SelectRow(y, &found);
    }
    return found;
  }

 private:
  // Columns before and after those of the second image in which hypotheses end.
  static constexpr int kBefore = -kFirst;

  size_t At(int x, int y) const {
    return (static_cast<size_t>(y) * static_cast<size_t>(first_.width) + static_cast<size_t>(x)) *
           kCount;
  }

  // Hamming distances of the signatures of a row.
  void Match(int y) {
    const size_t start = first_.StartOf(y);
    std::array<const uint8_t*, CensusImage::kNumPlanes> firsts;
    std::array<const uint8_t*, CensusImage::kNumPlanes> seconds;
    for (int plane = 0; plane < CensusImage::kNumPlanes; ++plane) {
      firsts[plane] = &first_.planes[plane][start];
      seconds[plane] = &second_.planes[plane][start + kFirst];
    }
    const uint8_t* least_cost = &second_.least_cost[start + kFirst];
    uint8_t* matching = &matching_[At(0, y)];
    const int width = first_.width;
    for (int x = 0; x < width; ++x) {
      HypothesisCosts<kVectors> costs;
      for (int i = 0; i < kVectors; ++i) {
        const int other = x + i * kByteLanes;
        Bytes bits = SetBytes(0);
        for (int plane = 0; plane < CensusImage::kNumPlanes; ++plane) {
          bits = Plus(bits,
                      DifferingBits(SetBytes(firsts[plane][x]), LoadBytes(seconds[plane] + other)));
        }
        costs.vectors[i] = Most(bits, LoadBytes(least_cost + other));
      }
      costs.Store(matching + x * kCount);
    }
  }

  // Sets the sums of a row to those of the paths to the right and to the left.
  void AggregateRow(int y) {
    const Bytes small = SetBytes(penalties_.small);
    const Bytes large = SetBytes(penalties_.large);
    PathCosts<kVectors> right{HypothesisCosts<kVectors>::Load(kZero)};
    PathCosts<kVectors> left = right;
    uint8_t* sums = &sums_[At(0, y)];
    const uint8_t* matching = &matching_[At(0, y)];
    const int end = first_.width;
    // Both paths meet in the middle: before it each is the first that reaches a pixel.
    for (int x = 0; x < end; ++x) {
      const int ahead = x * kCount;
      const int back = (end - 1 - x) * kCount;
      const auto at_right =
          right.Advance(HypothesisCosts<kVectors>::Load(matching + ahead), small, large);
      const auto at_left =
          left.Advance(HypothesisCosts<kVectors>::Load(matching + back), small, large);
      if (x < end / 2) {
        at_right.Store(sums + ahead);
        at_left.Store(sums + back);
      } else {
        at_right.AddTo(sums + ahead);
        at_left.AddTo(sums + back);
      }
    }
  }

  // Moves the paths along all columns to row y, and adds their costs to the sums.
  void AdvanceColumns(int y, bool adds, uint8_t* paths) {
    const Bytes small = SetBytes(penalties_.small);
    const Bytes large = SetBytes(penalties_.large);
    uint8_t* sums = &sums_[At(0, y)];
    const uint8_t* matching = &matching_[At(0, y)];
    for (int at = 0; at < first_.width * kCount; at += kCount) {
      PathCosts<kVectors> path{HypothesisCosts<kVectors>::Load(paths + at)};
      const auto next = path.Advance(HypothesisCosts<kVectors>::Load(matching + at), small, large);
      path.costs.Store(paths + at);
      if (adds) next.AddTo(sums + at);
    }
  }

  void SelectRow(int y, FoundDisparities* found) {
    std::ranges::fill(least_of_second_, 255);
    std::ranges::fill(first_of_second_, -1);
    const uint8_t* sums = &sums_[At(0, y)];
    const uint8_t* matching = &matching_[At(0, y)];
    best_.resize(first_.width);
    float* disparity = found->disparity.ptr<float>(y);
    float* uniqueness = found->uniqueness.ptr<float>(y);
    uint8_t* cost = found->cost.ptr<uint8_t>(y);
    for (int x = 0; x < first_.width; ++x) {
      const uint8_t* sum = sums + x * kCount;
      const auto costs = HypothesisCosts<kVectors>::Load(sum);
      const Bytes least = costs.LeastInAllLanes();
      int best = 0;
      Bytes second = SetBytes(255);
      for (int i = kVectors - 1; i >= 0; --i) {
        const int lane = FirstEqual(costs.vectors[i], least);
        if (lane >= 0) best = i * kByteLanes + lane;
      }
      for (int i = 0; i < kVectors; ++i) {
        // 255 in the lanes of the best hypothesis and of its neighbours.
        const Bytes beside = LoadBytes(&kBesideMiddle[kMiddle - best + i * kByteLanes]);
        second = Least(second, Most(costs.vectors[i], beside));
        const int other = x + i * kByteLanes;  // x + kFirst + kBefore
        const Bytes present = LoadBytes(&least_of_second_[other]);
        SetWhereLess(costs.vectors[i], present, static_cast<int16_t>(x), &first_of_second_[other]);
        StoreBytes(Least(costs.vectors[i], present), &least_of_second_[other]);
      }
      best_[x] = best;
      const int least_sum = FirstLane(least);
      float refinement = 0;
      if (best > 0 && best + 1 < kCount) {
        const int before = sum[best - 1];
        const int after = sum[best + 1];
        const int curvature = before - 2 * least_sum + after;
        if (curvature > 0) {
          refinement = 0.5f * static_cast<float>(before - after) / static_cast<float>(curvature);
        }
      }
      disparity[x] = static_cast<float>(kFirst + best) + refinement;
      uniqueness[x] = static_cast<float>(FirstLane(LeastOfLanes(second)) + 1) /
                      static_cast<float>(least_sum + 1);
      cost[x] = matching[x * kCount + best];
    }
    uint8_t* difference = found->difference.ptr<uint8_t>(y);
    for (int x = 0; x < first_.width; ++x) {
      const int other = x + kFirst + best_[x];
      const bool is_inside = other >= 0 && other < first_.width;
      const int back = is_inside ? first_of_second_[other + kBefore] : -1;
      difference[x] = static_cast<uint8_t>(back < 0 ? 255 : std::min(std::abs(back - x), 255));
    }
  }

  static constexpr uint8_t kZero[kCount] = {};
  static constexpr int kMiddle = kCount;
  static constexpr auto kBesideMiddle = [] {
    std::array<uint8_t, 2 * kCount> table{};
    for (int i = kMiddle - 1; i <= kMiddle + 1; ++i) table[i] = 255;
    return table;
  }();

  const CensusImage& first_;
  const CensusImage& second_;
  const DisparityPenalties penalties_;
  std::unique_ptr<uint8_t[]> matching_;
  std::unique_ptr<uint8_t[]> sums_;
  // By column of the second image: the least sum of a row and the first image's column that has it.
  std::vector<uint8_t> least_of_second_;
  std::vector<int16_t> first_of_second_;
  std::vector<int> best_;
};

FoundDisparities SearchWide(const CensusImage& first, const CensusImage& second,
                            const DisparityPenalties& penalties) {
  return DisparitySearch<2, 0>(first, second, penalties).Run();
}

FoundDisparities SearchAround(const CensusImage& first, const CensusImage& second,
                              const DisparityPenalties& penalties) {
  return DisparitySearch<1, -8>(first, second, penalties).Run();
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(SearchWide);
HWY_EXPORT(SearchAround);

FoundDisparities SearchDisparities(const CensusImage& first, const CensusImage& second,
                                   DisparityRange range, const DisparityPenalties& penalties) {
  ORB360_CHECK(
      first.width == second.width && first.height == second.height && first.height >= kPathLead,
      first.width, first.height);
  ORB360_CHECK(0 < penalties.small && penalties.small <= penalties.large && penalties.large <= 39,
               penalties.small, penalties.large);
  return range == DisparityRange::kWide
             ? HWY_DYNAMIC_DISPATCH(SearchWide)(first, second, penalties)
             : HWY_DYNAMIC_DISPATCH(SearchAround)(first, second, penalties);
}

}  // namespace orb360
#endif
