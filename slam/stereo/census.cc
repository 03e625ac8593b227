#include "slam/stereo/census.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/census.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// `around`: the five rows of the window, from the pixel two columns before the first one on.
void TransformRow(const std::array<const uint8_t*, 5>& around, int width,
                  const std::array<uint8_t*, CensusImage::kNumPlanes>& to) {
  const hn::ScalableTag<uint8_t> d;
  const auto one = hn::Set(d, 1);
  const int lanes = static_cast<int>(hn::Lanes(d));
  // The last vector may reach into the margins.
  for (int x = 0; x < width; x += lanes) {
    const auto center = hn::LoadU(d, around[2] + x + 2);
    auto bits = hn::Zero(d);
    int count = 0;
    for (int i = 0; i < 25; ++i) {
      if (i == 12) continue;
      const auto neighbour = hn::LoadU(d, around[i / 5] + x + i % 5);
      bits =
          hn::Add(hn::Add(bits, bits), hn::And(hn::VecFromMask(d, hn::Lt(neighbour, center)), one));
      if (++count % 8 != 0) continue;
      hn::StoreU(bits, d, to[count / 8 - 1] + x);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(TransformRow);

CensusImage::CensusImage(int columns, int rows) : width(columns), height(rows) {
  for (std::vector<uint8_t>& plane : planes) plane.assign(StartOf(rows), 0);
  least_cost.assign(StartOf(rows), kCensusBits);
}

CensusImage TransformCensus(const cv::Mat& gray, const cv::Mat& is_outside, int num_threads) {
  constexpr int kRadius = 2;
  // The widest vector of any instruction set, so that the last one of a row stays inside.
  constexpr int kMaxLanes = 64;
  const int width = gray.cols;
  const int height = gray.rows;
  cv::Mat padded(height + 2 * kRadius, width + 2 * kRadius + kMaxLanes, CV_8U, cv::Scalar(0));
  for (int y = -kRadius; y < height + kRadius; ++y) {
    const uint8_t* from = gray.ptr((y + height) % height);
    uint8_t* to = padded.ptr(y + kRadius);
    std::copy(from, from + width, to + kRadius);
    std::fill(to, to + kRadius, from[0]);
    std::fill(to + kRadius + width, to + 2 * kRadius + width, from[width - 1]);
  }
  CensusImage census(width, height);
#pragma omp parallel num_threads(num_threads)
  {
    std::array<std::vector<uint8_t>, CensusImage::kNumPlanes> signatures;
    std::array<uint8_t*, CensusImage::kNumPlanes> to;
    for (int plane = 0; plane < CensusImage::kNumPlanes; ++plane) {
      signatures[plane].resize(width + kMaxLanes);
      to[plane] = signatures[plane].data();
    }
#pragma omp for schedule(static)
    for (int y = 0; y < height; ++y) {
      HWY_DYNAMIC_DISPATCH(TransformRow)
      ({padded.ptr(y), padded.ptr(y + 1), padded.ptr(y + 2), padded.ptr(y + 3), padded.ptr(y + 4)},
       width, to);
      for (int plane = 0; plane < CensusImage::kNumPlanes; ++plane) {
        std::copy_n(to[plane], width, &census.planes[plane][census.StartOf(y)]);
      }
      uint8_t* least = &census.least_cost[census.StartOf(y)];
      const uint8_t* outside = is_outside.ptr(y);
      for (int x = 0; x < width; ++x) least[x] = outside[x] != 0 ? kCensusBits : 0;
    }
  }
  return census;
}

}  // namespace orb360
#endif
