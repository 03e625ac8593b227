#include "slam/stereo/inverse_ranges.h"

#include <array>

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/inverse_ranges.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Fuses the pixels from x on that fill one vector of type D.
template <class D>
HWY_INLINE void FusePixels(D d, std::span<const InverseRanges> measured,
                           const InverseRangeFusionOptions& options, int row, int x,
                           InverseRanges* fused) {
  using V = hn::Vec<D>;
  const auto count = static_cast<int>(measured.size());
  V values[kMaxStereoSources];
  V variances[kMaxStereoSources];
  V weights[kMaxStereoSources];
  const V zero = hn::Zero(d);
  for (int i = 0; i < count; ++i) {
    values[i] = hn::LoadU(d, measured[i].value.template ptr<float>(row) + x);
    const V sigma = hn::LoadU(d, measured[i].sigma.template ptr<float>(row) + x);
    variances[i] = hn::Mul(sigma, sigma);
    weights[i] = hn::IfThenElseZero(hn::Gt(sigma, zero), hn::Div(hn::Set(d, 1.0f), variances[i]));
  }
  const V tolerance = hn::Set(d, static_cast<float>(options.max_sigmas * options.max_sigmas));
  V most = zero;
  V best_sum = zero;
  V best_weight = zero;
  for (int i = 0; i < count; ++i) {
    V support = zero;
    V sum = zero;
    V weight = zero;
    for (int j = 0; j < count; ++j) {
      const V difference = hn::Sub(values[j], values[i]);
      const auto agrees = hn::And(hn::Gt(weights[j], zero),
                                  hn::Le(hn::Mul(difference, difference),
                                         hn::Mul(tolerance, hn::Add(variances[i], variances[j]))));
      const V share = hn::IfThenElseZero(agrees, weights[j]);
      support = hn::Add(support, hn::IfThenElseZero(agrees, hn::Set(d, 1.0f)));
      sum = hn::MulAdd(share, values[j], sum);
      weight = hn::Add(weight, share);
    }
    const auto is_larger = hn::And(hn::Gt(weights[i], zero), hn::Gt(support, most));
    most = hn::IfThenElse(is_larger, support, most);
    best_sum = hn::IfThenElse(is_larger, sum, best_sum);
    best_weight = hn::IfThenElse(is_larger, weight, best_weight);
  }
  const V value = hn::Div(best_sum, best_weight);
  const V sigma = hn::Sqrt(hn::Div(hn::Set(d, 1.0f), best_weight));
  const auto is_known =
      hn::And(hn::Ge(most, hn::Set(d, static_cast<float>(options.min_support))),
              hn::Lt(sigma, hn::Mul(hn::Set(d, static_cast<float>(options.max_sigma)), value)));
  hn::StoreU(hn::IfThenElseZero(is_known, value), d, fused->value.template ptr<float>(row) + x);
  hn::StoreU(hn::IfThenElseZero(is_known, sigma), d, fused->sigma.template ptr<float>(row) + x);
}

void FuseRow(std::span<const InverseRanges> measured, const InverseRangeFusionOptions& options,
             int row, InverseRanges* fused) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  const int width = fused->value.cols;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) FusePixels(d, measured, options, row, x, fused);
  for (; x < width; ++x) FusePixels(one, measured, options, row, x, fused);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(FuseRow);

InverseRanges FuseInverseRanges(std::span<const InverseRanges> measured,
                                const InverseRangeFusionOptions& options, int num_threads) {
  ORB360_CHECK(!measured.empty() && measured.size() <= kMaxStereoSources, measured.size());
  const cv::Size size = measured.front().value.size();
  InverseRanges fused{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int row = 0; row < size.height; ++row) {
    HWY_DYNAMIC_DISPATCH(FuseRow)(measured, options, row, &fused);
  }
  return fused;
}

}  // namespace orb360
#endif
