#include "slam/stereo/disparity_triangulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/stereo/disparity_triangulation.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#ifndef ORB360_SLAM_STEREO_DISPARITY_TRIANGULATION_CC_
#define ORB360_SLAM_STEREO_DISPARITY_TRIANGULATION_CC_
namespace orb360 {

// What is the same in all rows; the vectors reach a margin beyond the last column.
struct RectifiedColumns {
  std::vector<float> sines;    // of the angle from the baseline
  std::vector<float> cosines;  // of the same
  // Factor of the refinement's standard deviation. Rows are nearer to each other towards the
  // epipoles, so that a window there has fewer independent pixels.
  std::vector<float> sigma_factors;
  float pixel_angle;
  float length;
  float least_sine;
  float least_sigma;
};

}  // namespace orb360
#endif

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void TriangulateRow(const RectifiedColumns& columns, const float* disparity, const float* sigma,
                    int width, float* value, float* deviation) {
  const hn::CappedTag<float, 16> d;
  using V = hn::Vec<decltype(d)>;
  const V pixel_angle = hn::Set(d, columns.pixel_angle);
  const V length = hn::Set(d, columns.length);
  const V least_sine = hn::Set(d, columns.least_sine);
  const V least_variance = hn::Set(d, columns.least_sigma * columns.least_sigma);
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d))) {
    const V shift = hn::LoadU(d, disparity + x);
    const V sine1 = hn::LoadU(d, columns.sines.data() + x);
    const V cosine1 = hn::LoadU(d, columns.cosines.data() + x);
    const V angle = hn::Mul(hn::Max(shift, hn::Zero(d)), pixel_angle);
    const V sine = hn::Sin(d, angle);
    // At the source view.
    const V sine2 = hn::MulAdd(sine1, hn::Cos(d, angle), hn::Mul(cosine1, sine));
    const auto is_known = hn::And(hn::Ge(shift, hn::Zero(d)),
                                  hn::And(hn::Ge(sine1, least_sine), hn::Ge(sine2, least_sine)));
    const V distance = hn::Mul(sine2, length);
    const V refined =
        hn::Mul(hn::LoadU(d, sigma + x), hn::LoadU(d, columns.sigma_factors.data() + x));
    const V spread = hn::Sqrt(hn::MulAdd(refined, refined, least_variance));
    // The derivative by the disparity.
    const V derivative =
        hn::Div(hn::Mul(hn::Mul(pixel_angle, length), sine1), hn::Mul(distance, distance));
    hn::StoreU(hn::IfThenElseZero(is_known, hn::Div(sine, distance)), d, value + x);
    hn::StoreU(hn::IfThenElseZero(is_known, hn::Mul(spread, derivative)), d, deviation + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(TriangulateRow);

InverseRanges TriangulateDisparities(const RefinedDisparities& disparities, double length,
                                     const DisparityTriangulationOptions& options) {
  const cv::Size size = disparities.disparity.size();
  // Vectors of the last column may reach beyond it.
  constexpr int kMargin = 16;
  const double pixel_angle = std::numbers::pi / size.width;
  RectifiedColumns columns{.sines = std::vector<float>(size.width + kMargin),
                           .cosines = std::vector<float>(size.width + kMargin),
                           .sigma_factors = std::vector<float>(size.width + kMargin),
                           .pixel_angle = static_cast<float>(pixel_angle),
                           .length = static_cast<float>(length),
                           .least_sine = static_cast<float>(std::sin(options.min_epipolar_angle)),
                           .least_sigma = static_cast<float>(options.min_disparity_sigma)};
  for (int x = 0; x < size.width; ++x) {
    const double angle = (x + 0.5) * pixel_angle;
    columns.sines[x] = static_cast<float>(std::sin(angle));
    columns.cosines[x] = static_cast<float>(std::cos(angle));
    columns.sigma_factors[x] =
        static_cast<float>(options.disparity_sigma_factor / std::sqrt(std::sin(angle)));
  }
  std::vector<float> shifts(size.width + kMargin);
  std::vector<float> sigmas(size.width + kMargin);
  std::vector<float> values(size.width + kMargin);
  std::vector<float> deviations(size.width + kMargin);
  InverseRanges ranges{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  for (int y = 0; y < size.height; ++y) {
    std::copy_n(disparities.disparity.ptr<float>(y), size.width, shifts.begin());
    std::copy_n(disparities.sigma.ptr<float>(y), size.width, sigmas.begin());
    HWY_DYNAMIC_DISPATCH(TriangulateRow)
    (columns, shifts.data(), sigmas.data(), size.width, values.data(), deviations.data());
    std::copy_n(values.begin(), size.width, ranges.value.ptr<float>(y));
    std::copy_n(deviations.begin(), size.width, ranges.sigma.ptr<float>(y));
  }
  return ranges;
}

}  // namespace orb360
#endif
