#include "slam/depth/surface_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/depth/surface_normals.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "slam/depth/row_lanes-inl.h"

#ifndef ORB360_SLAM_DEPTH_SURFACE_NORMALS_CC_
#define ORB360_SLAM_DEPTH_SURFACE_NORMALS_CC_
namespace orb360 {

/// One of the pixels to which a plane is fitted.
struct PlaneTap {
  std::int32_t first;   // pixel of its row, by place in the image
  std::int32_t offset;  // of its column from the point's, 0 to width - 1: beyond the seam it wraps
  // Its bearing relative to the point: along the point's bearing, and to the east and north of it
  // in pixels. It is the same for all points of a row.
  float forward;
  float east;
  float north;
};

}  // namespace orb360
#endif

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {

void FitNormalsKernel(const float* inverse_ranges, int width, const PlaneTap* taps, size_t num_taps,
                      int row, float sine_of_latitude, float cosine_of_latitude, float pixel_angle,
                      TestedRow* points) {
  const D d;
  const DI di;
  // A pixel has half of its weight when its ln(range) differs from the point's by this much.
  constexpr float kPlaneScale = 0.15f;
  // If the remaining neighbours lie on one line, the slope across it is set to zero by this small
  // weight. For neighbours at a distance of one pixel it changes no other slope.
  constexpr float kRidge = 2e-3f;
  const VI last = hn::Set(di, width);
  const VI start = hn::Set(di, row * width);
  for (size_t i = 0; i < points->size; i += hn::Lanes(d)) {
    const VI column = hn::LoadU(di, points->column.data() + i);
    const V centre = hn::GatherIndex(d, inverse_ranges, hn::Add(start, column));
    const V scale = hn::Div(Constant(1), centre);
    // Normal equations of the plane 1 / range = forward * f + east * e + north * n, in units of the
    // point's own.
    V ff = hn::Zero(d), fe = ff, fn = ff, ee = ff, en = ff, nn = ff, fq = ff, eq = ff, nq = ff;
    V total = ff;
    for (size_t t = 0; t < num_taps; ++t) {
      const PlaneTap& tap = taps[t];
      const VI at = Wrap(hn::Add(column, hn::Set(di, tap.offset)), last);
      const V ratio =
          hn::Mul(scale, hn::GatherIndex(d, inverse_ranges, hn::Add(hn::Set(di, tap.first), at)));
      const V difference = hn::Mul(hn::Sub(ratio, Constant(1)), Constant(1 / kPlaneScale));
      const V counted = hn::Div(Constant(1), hn::MulAdd(difference, difference, Constant(1)));
      const V weight = hn::IfThenElseZero(hn::Gt(ratio, hn::Zero(d)), counted);
      const V forward = hn::Mul(weight, Constant(tap.forward));
      const V east = hn::Mul(weight, Constant(tap.east));
      const V north = hn::Mul(weight, Constant(tap.north));
      ff = hn::MulAdd(forward, Constant(tap.forward), ff);
      fe = hn::MulAdd(forward, Constant(tap.east), fe);
      fn = hn::MulAdd(forward, Constant(tap.north), fn);
      ee = hn::MulAdd(east, Constant(tap.east), ee);
      en = hn::MulAdd(east, Constant(tap.north), en);
      nn = hn::MulAdd(north, Constant(tap.north), nn);
      fq = hn::MulAdd(forward, ratio, fq);
      eq = hn::MulAdd(east, ratio, eq);
      nq = hn::MulAdd(north, ratio, nq);
      total = hn::Add(total, weight);
    }
    ee = hn::MulAdd(Constant(kRidge), total, ee);
    nn = hn::MulAdd(Constant(kRidge), total, nn);
    // Eliminates f, then e.
    const V f_pivot = hn::Div(Constant(1), ff);
    const V fe_ratio = hn::Mul(fe, f_pivot);
    const V fn_ratio = hn::Mul(fn, f_pivot);
    ee = hn::NegMulAdd(fe_ratio, fe, ee);
    en = hn::NegMulAdd(fe_ratio, fn, en);
    nn = hn::NegMulAdd(fn_ratio, fn, nn);
    eq = hn::NegMulAdd(fe_ratio, fq, eq);
    nq = hn::NegMulAdd(fn_ratio, fq, nq);
    const V en_ratio = hn::Div(en, ee);
    nn = hn::NegMulAdd(en_ratio, en, nn);
    nq = hn::NegMulAdd(en_ratio, eq, nq);
    const V n = hn::Div(nq, nn);
    const V e = hn::Div(hn::NegMulAdd(en, n, eq), ee);
    const V f = hn::Mul(hn::NegMulAdd(fe, e, hn::NegMulAdd(fn, n, fq)), f_pivot);
    // East and north are in pixels.
    const V along_east = hn::Mul(e, Constant(1 / pixel_angle));
    const V along_north = hn::Mul(n, Constant(1 / pixel_angle));
    const V squared =
        hn::MulAdd(f, f, hn::MulAdd(along_east, along_east, hn::Mul(along_north, along_north)));
    const auto is_plane = hn::And(hn::Gt(squared, hn::Zero(d)), hn::Lt(squared, Constant(1e30f)));
    const V length = hn::Div(Constant(1), hn::Sqrt(squared));
    const V sign = hn::IfThenElse(hn::Gt(f, hn::Zero(d)), hn::Neg(length), length);
    const V bx = hn::LoadU(d, points->bearing[0].data() + i);
    const V by = hn::LoadU(d, points->bearing[1].data() + i);
    const V bz = hn::LoadU(d, points->bearing[2].data() + i);
    // East is (b_y, -b_x, 0) and north (-b_x b_z, -b_y b_z, cos^2) over the cosine of latitude.
    const V east = hn::Mul(along_east, Constant(1 / cosine_of_latitude));
    const V north = hn::Mul(along_north, Constant(-sine_of_latitude / cosine_of_latitude));
    const V x = hn::MulAdd(f, bx, hn::MulAdd(east, by, hn::Mul(north, bx)));
    const V y = hn::MulAdd(f, by, hn::NegMulAdd(east, bx, hn::Mul(north, by)));
    const V z = hn::MulAdd(f, bz, hn::Mul(along_north, Constant(cosine_of_latitude)));
    hn::StoreU(hn::IfThenElseZero(is_plane, hn::Mul(sign, x)), d, points->normal[0].data() + i);
    hn::StoreU(hn::IfThenElseZero(is_plane, hn::Mul(sign, y)), d, points->normal[1].data() + i);
    hn::StoreU(hn::IfThenElseZero(is_plane, hn::Mul(sign, z)), d, points->normal[2].data() + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(FitNormalsKernel);

void FitNormals(const DepthView& view, TestedRow* points) {
  // Number of pixels on either side.
  constexpr int kReach = 2;
  const int width = view.width();
  const double pixel_angle = std::numbers::pi / view.height();
  const auto latitude_of = [&](int row) {
    return 0.5 * std::numbers::pi - pixel_angle * (row + 0.5);
  };
  const double latitude = latitude_of(points->row);
  std::vector<PlaneTap> taps;
  for (int row = std::max(0, points->row - kReach);
       row <= std::min(view.height() - 1, points->row + kReach); ++row) {
    const double other = latitude_of(row);
    const int step = ColumnStep(std::cos(other));
    for (int i = -kReach; i <= kReach; ++i) {
      const double turn = 2.0 * std::numbers::pi * i * step / width;
      const double level = std::cos(other) * std::cos(turn);
      const double forward = std::cos(latitude) * level + std::sin(latitude) * std::sin(other);
      const double east = std::cos(other) * std::sin(turn);
      const double north = std::cos(latitude) * std::sin(other) - std::sin(latitude) * level;
      taps.push_back({row * width, (i * step % width + width) % width, static_cast<float>(forward),
                      static_cast<float>(east / pixel_angle),
                      static_cast<float>(north / pixel_angle)});
    }
  }
  HWY_DYNAMIC_DISPATCH(FitNormalsKernel)
  (view.inverse_ranges().data(), width, taps.data(), taps.size(), points->row,
   static_cast<float>(std::sin(latitude)), static_cast<float>(std::cos(latitude)),
   static_cast<float>(pixel_angle), points);
}

}  // namespace orb360
#endif
