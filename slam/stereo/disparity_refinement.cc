#include "slam/stereo/disparity_refinement.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/imgproc.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/disparity_refinement.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#ifndef ORB360_SLAM_STEREO_DISPARITY_REFINEMENT_CC_
#define ORB360_SLAM_STEREO_DISPARITY_REFINEMENT_CC_
namespace orb360 {

// Columns before and after those of a row, so that windows and vectors may reach beyond them.
constexpr int kMargin = 32;
constexpr int kRadius = 2;
constexpr int kSide = 2 * kRadius + 1;

// Of each pixel of a row: its weight, the difference e of the images, the gradient g, ee, ge, gg.
// The first pixel is at kMargin; the margins are zero.
enum Term { kWeight, kE, kG, kEe, kGe, kGg, kNumTerms };
using TermRow = std::array<std::vector<float>, kNumTerms>;

}  // namespace orb360
#endif

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using VF = hn::Vec<DF>;

// The terms of a row. `first` and `second` have margins. What lies past the end has no weight.
void ComputeTerms(const float* first, const float* second, const float* disparity, int width,
                  TermRow* terms) {
  const DF d;
  const hn::RebindToSigned<DF> di;
  const VF half = hn::Set(d, 0.5f);
  const auto end = hn::Set(d, static_cast<float>(width));
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d))) {
    const VF here = hn::Iota(d, static_cast<float>(x));
    const VF shift = hn::LoadU(d, disparity + x);
    const auto is_known = hn::And(hn::Ge(shift, hn::Zero(d)), hn::Lt(here, end));
    const VF column = hn::Min(hn::Max(hn::Add(here, shift), hn::Zero(d)),
                              hn::Set(d, static_cast<float>(width - 1)));
    const auto left = hn::ConvertTo(di, column);
    const VF fraction = hn::Sub(column, hn::ConvertTo(d, left));
    VF at[4];
    for (int i = 0; i < 4; ++i) {
      at[i] = hn::GatherIndex(d, second - 1, hn::Add(left, hn::Set(di, i)));
    }
    const VF value = hn::MulAdd(fraction, hn::Sub(at[2], at[1]), at[1]);
    const VF rise = hn::Sub(at[2], at[0]);
    const VF second_gradient = hn::MulAdd(fraction, hn::Sub(hn::Sub(at[3], at[1]), rise), rise);
    const VF first_gradient = hn::Sub(hn::LoadU(d, first + x + 1), hn::LoadU(d, first + x - 1));
    // The mean of both derivatives, each half of a difference over two pixels.
    const VF g = hn::IfThenElseZero(
        is_known, hn::Mul(hn::Mul(half, half), hn::Add(first_gradient, second_gradient)));
    const VF e = hn::IfThenElseZero(is_known, hn::Sub(value, hn::LoadU(d, first + x)));
    const auto store = [&](VF v, Term term)
                           HWY_ATTR { hn::StoreU(v, d, (*terms)[term].data() + kMargin + x); };
    store(hn::IfThenElseZero(is_known, hn::Set(d, 1.0f)), kWeight);
    store(e, kE);
    store(g, kG);
    store(hn::Mul(e, e), kEe);
    store(hn::Mul(g, e), kGe);
    store(hn::Mul(g, g), kGg);
  }
}

// The mean of the disparities in the window around each pixel of a row that differ by at most
// `max_difference` from its own. `rows` are those of the window, and have margins.
void SmoothRow(std::span<const float* const> rows, float max_difference, int width,
               float* smoothed) {
  const int radius = static_cast<int>(rows.size()) / 2;
  const DF d;
  const VF zero = hn::Zero(d);
  const VF limit = hn::Set(d, max_difference);
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d))) {
    const VF center = hn::LoadU(d, rows[radius] + x);
    VF sum = zero;
    VF count = zero;
    for (const float* row : rows) {
      for (int i = -radius; i <= radius; ++i) {
        const VF other = hn::LoadU(d, row + x + i);
        const auto is_near =
            hn::And(hn::Ge(other, zero), hn::Le(hn::Abs(hn::Sub(other, center)), limit));
        sum = hn::Add(sum, hn::IfThenElseZero(is_near, other));
        count = hn::Add(count, hn::IfThenElseZero(is_near, hn::Set(d, 1.0f)));
      }
    }
    hn::StoreU(hn::IfThenElse(hn::Ge(center, zero), hn::Div(sum, count), center), d, smoothed + x);
  }
}

// The sums of the rows' terms in each column, also in as many columns of the margins as windows
// reach.
void SumColumns(const std::array<const TermRow*, kSide>& rows, int width, TermRow* sums) {
  const DF d;
  for (int term = 0; term < kNumTerms; ++term) {
    for (int x = -kRadius; x < width + kRadius; x += static_cast<int>(hn::Lanes(d))) {
      VF sum = hn::Zero(d);
      for (const TermRow* row : rows) {
        sum = hn::Add(sum, hn::LoadU(d, (*row)[term].data() + kMargin + x));
      }
      hn::StoreU(sum, d, (*sums)[term].data() + kMargin + x);
    }
  }
}

// Moves the disparities of a row by a Gauss-Newton step, from the terms of the rows around it.
// `column_sums` is overwritten.
void RefineRow(const std::array<const TermRow*, kSide>& rows,
               const DisparityRefinementOptions& options, int width, TermRow* column_sums,
               float* disparity, float* sigma) {
  SumColumns(rows, width, column_sums);
  const DF d;
  const VF zero = hn::Zero(d);
  const VF limit = hn::Set(d, static_cast<float>(options.max_step));
  const VF noise = hn::Set(d, static_cast<float>(options.gray_sigma * options.gray_sigma));
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d))) {
    VF sums[kNumTerms];
    for (int term = 0; term < kNumTerms; ++term) {
      sums[term] = zero;
      for (int i = -kRadius; i <= kRadius; ++i) {
        sums[term] =
            hn::Add(sums[term], hn::LoadU(d, (*column_sums)[term].data() + kMargin + x + i));
      }
    }
    // Central moments.
    const VF scale = hn::Div(hn::Set(d, 1.0f), hn::Max(sums[kWeight], hn::Set(d, 1.0f)));
    const VF mean_e = hn::Mul(sums[kE], scale);
    const VF mean_g = hn::Mul(sums[kG], scale);
    const VF gg = hn::Sub(sums[kGg], hn::Mul(mean_g, sums[kG]));
    const VF ge = hn::Sub(sums[kGe], hn::Mul(mean_g, sums[kE]));
    const VF ee = hn::Sub(sums[kEe], hn::Mul(mean_e, sums[kE]));
    const VF present = hn::LoadU(d, disparity + x);
    // A gradient of less than 0.2 levels is none.
    const auto is_known =
        hn::And(hn::Ge(present, zero),
                hn::And(hn::Gt(gg, hn::Set(d, 1.0f)), hn::Ge(sums[kWeight], hn::Set(d, 3.0f))));
    const VF change = hn::Min(hn::Max(hn::Neg(hn::Div(ge, gg)), hn::Neg(limit)), limit);
    const VF rest = hn::Max(zero, hn::MulAdd(change, hn::MulAdd(change, gg, hn::Add(ge, ge)), ee));
    const VF variance = hn::Div(hn::MulAdd(rest, scale, noise), gg);
    const VF unknown = hn::Set(d, -1.0f);
    hn::StoreU(hn::IfThenElse(is_known, hn::Max(zero, hn::Add(present, change)), unknown), d,
               disparity + x);
    hn::StoreU(hn::IfThenElse(is_known, hn::Sqrt(variance), unknown), d, sigma + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(ComputeTerms);
HWY_EXPORT(RefineRow);
HWY_EXPORT(SmoothRow);

// Smooths disparities, which have margins, in windows of the given radius.
cv::Mat Smooth(const cv::Mat& disparity, const DisparityRefinementOptions& options, int radius) {
  const int height = disparity.rows;
  cv::Mat smoothed = disparity.clone();
  for (int y = 0; y < height; ++y) {
    std::array<const float*, kSide> rows;
    for (int i = 0; i < 2 * radius + 1; ++i) {
      rows[i] = disparity.ptr<float>((y + i - radius + height) % height) + kMargin;
    }
    HWY_DYNAMIC_DISPATCH(SmoothRow)
    (std::span(rows).first(2 * radius + 1), static_cast<float>(options.max_difference),
     disparity.cols - 2 * kMargin, smoothed.ptr<float>(y) + kMargin);
  }
  return smoothed;
}

// CV_32F with margins that repeat the border.
cv::Mat WithMargins(const cv::Mat& image) {
  cv::Mat padded;
  cv::copyMakeBorder(image, padded, 0, 0, kMargin, kMargin, cv::BORDER_REPLICATE);
  padded.convertTo(padded, CV_32F);
  return padded;
}

}  // namespace

RefinedDisparities RefineDisparities(const cv::Mat& first, const cv::Mat& second,
                                     const cv::Mat& disparity,
                                     const DisparityRefinementOptions& options) {
  const int width = disparity.cols;
  const int height = disparity.rows;
  const cv::Mat first_values = WithMargins(first);
  const cv::Mat second_values = WithMargins(second);
  cv::Mat present = WithMargins(disparity);
  cv::Mat next(present.size(), CV_32F);
  cv::Mat sigma(present.size(), CV_32F);
  std::array<TermRow, kSide> terms;
  TermRow column_sums;
  const auto clear = [width](TermRow* row) {
    for (std::vector<float>& term : *row) {
      term.assign(static_cast<size_t>(width) + 2 * kMargin, 0.0f);
    }
  };
  for (TermRow& row : terms) clear(&row);
  clear(&column_sums);
  for (int step = 0; step < options.num_steps; ++step) {
    // The first step has removed most of what rounding has made.
    present = Smooth(present, options, step == 0 ? kRadius : 1);
    present.copyTo(next);
    for (int i = 0; i < height + 2 * kRadius; ++i) {
      const int y = (i - kRadius + height) % height;
      HWY_DYNAMIC_DISPATCH(ComputeTerms)
      (first_values.ptr<float>(y) + kMargin, second_values.ptr<float>(y) + kMargin,
       present.ptr<float>(y) + kMargin, width, &terms[i % kSide]);
      if (i < 2 * kRadius) continue;
      HWY_DYNAMIC_DISPATCH(RefineRow)
      ({&terms[0], &terms[1], &terms[2], &terms[3], &terms[4]}, options, width, &column_sums,
       next.ptr<float>(i - 2 * kRadius) + kMargin, sigma.ptr<float>(i - 2 * kRadius) + kMargin);
    }
    cv::swap(present, next);
  }
  const cv::Rect inside(kMargin, 0, width, height);
  return {present(inside).clone(), sigma(inside).clone()};
}

}  // namespace orb360
#endif
