#include "slam/stereo/row_warp.h"

#include <algorithm>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/row_warp.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Samples the columns from x on that fill one vector of type D.
template <class D>
HWY_INLINE void WarpPixels(D d, const float* from, const float* disparity, int width, int x,
                           float* to) {
  using V = hn::Vec<D>;
  const hn::RebindToSigned<D> di;
  const V column = hn::Add(hn::Iota(d, static_cast<float>(x)), hn::LoadU(d, disparity + x));
  const V inside = hn::Min(hn::Max(column, hn::Zero(d)), hn::Set(d, static_cast<float>(width - 1)));
  const auto left = hn::Min(hn::ConvertTo(di, inside), hn::Set(di, width - 2));
  const V fraction = hn::Sub(inside, hn::ConvertTo(d, left));
  const V first = hn::GatherIndex(d, from, left);
  const V second = hn::GatherIndex(d, from, hn::Add(left, hn::Set(di, 1)));
  hn::StoreU(hn::MulAdd(fraction, hn::Sub(second, first), first), d, to + x);
}

void WarpRow(const float* from, const float* disparity, int width, float* to) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) WarpPixels(d, from, disparity, width, x, to);
  for (; x < width; ++x) WarpPixels(one, from, disparity, width, x, to);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(WarpRow);

WarpedRows WarpRows(const cv::Mat& image, const cv::Mat& disparity) {
  const int width = image.cols;
  WarpedRows warped{cv::Mat(image.size(), image.type()), cv::Mat(image.size(), CV_8U)};
  std::vector<float> values(width);
  std::vector<float> samples(width);
  const auto last = static_cast<float>(width - 1);
  for (int y = 0; y < image.rows; ++y) {
    const float* row = disparity.ptr<float>(y);
    if (image.depth() == CV_8U) {
      const uint8_t* from = image.ptr<uint8_t>(y);
      uint8_t* to = warped.image.ptr<uint8_t>(y);
      for (int x = 0; x < width; ++x) values[x] = static_cast<float>(from[x]);
      HWY_DYNAMIC_DISPATCH(WarpRow)(values.data(), row, width, samples.data());
      for (int x = 0; x < width; ++x) to[x] = static_cast<uint8_t>(samples[x] + 0.5f);
    } else {
      HWY_DYNAMIC_DISPATCH(WarpRow)
      (image.ptr<float>(y), row, width, warped.image.ptr<float>(y));
    }
    uint8_t* is_outside = warped.is_outside.ptr<uint8_t>(y);
    for (int x = 0; x < width; ++x) {
      const float column = static_cast<float>(x) + row[x];
      is_outside[x] = column < 0 || column > last ? 255 : 0;
    }
  }
  return warped;
}

}  // namespace orb360
#endif
