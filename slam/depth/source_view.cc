#include "slam/depth/source_view.h"

#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/depth/source_view.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "slam/depth/row_lanes-inl.h"
#include "slam/geometry/angle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {

/// What a keyframe sees in the direction of each point.
struct Sighting {
  V inverse_range;  // 0 where unknown
  V error;          // of ln(range), to be expected
  VI row;           // of the nearest pixel
  VI column;
};

/// Samples a view in the given directions, which are unit vectors in the camera frame.
HWY_INLINE Sighting LookAlong(const DepthView& view, V x, V y, V z) {
  const D d;
  const DI di;
  const DU du;
  constexpr float kPi = std::numbers::pi_v<float>;
  const VI width = hn::Set(di, view.width());
  const VI half = hn::Set(di, view.width() / 2);
  const VI zero = hn::Zero(di);
  const VI one = hn::Set(di, 1);
  const VI bottom_row = hn::Set(di, view.height() - 1);
  const V longitude = Angle(d, y, hn::Neg(x));
  const V latitude = Angle(d, z, hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y))));
  // Coordinates in pixels whose centres are at integers.
  const V u = hn::MulAdd(longitude, Constant(static_cast<float>(view.width()) / (2 * kPi)),
                         Constant(0.5f * static_cast<float>(view.width() - 1)));
  const V v = hn::MulAdd(latitude, Constant(static_cast<float>(-view.height()) / kPi),
                         Constant(0.5f * static_cast<float>(view.height() - 1)));
  const V whole_u = hn::Floor(u);
  const V whole_v = hn::Floor(v);
  const V right_fraction = hn::Sub(u, whole_u);
  const V bottom_fraction = hn::Sub(v, whole_v);
  // NaN becomes an arbitrary pixel inside the image.
  const VI left = hn::Max(hn::Min(hn::ConvertTo(di, whole_u), width), hn::Set(di, -1));
  const VI top = hn::Max(hn::Min(hn::ConvertTo(di, whole_v), bottom_row), hn::Set(di, -1));
  // Beyond a pole the first or last row continues at the opposite longitude.
  const VI upper_turn = hn::IfThenElseZero(hn::Lt(top, zero), half);
  const VI lower_turn = hn::IfThenElseZero(hn::Eq(top, bottom_row), half);
  const VI upper = hn::Mul(hn::Max(top, zero), width);
  const VI lower = hn::Mul(hn::Min(hn::Add(top, one), bottom_row), width);
  const VI left_wrapped = Wrap(left, width);
  const VI right_wrapped = Wrap(hn::Add(left, one), width);
  const float* inverse = view.inverse_ranges().data();
  const auto gather = [&](VI start, VI at, VI turn) HWY_ATTR {
    return hn::GatherIndex(d, inverse, hn::Add(start, Wrap(hn::Add(at, turn), width)));
  };
  const V upper_left = gather(upper, left_wrapped, upper_turn);
  const V upper_right = gather(upper, right_wrapped, upper_turn);
  const V lower_left = gather(lower, left_wrapped, lower_turn);
  const V lower_right = gather(lower, right_wrapped, lower_turn);

  const auto is_upper = hn::Lt(bottom_fraction, Constant(0.5f));
  const auto is_left = hn::Lt(right_fraction, Constant(0.5f));
  const VI row = hn::IfThenElse(hn::RebindMask(di, is_upper), hn::Max(top, zero),
                                hn::Min(hn::Add(top, one), bottom_row));
  const VI column = hn::IfThenElse(hn::RebindMask(di, is_left), left_wrapped, right_wrapped);
  const V nearest = hn::IfThenElse(is_upper, hn::IfThenElse(is_left, upper_left, upper_right),
                                   hn::IfThenElse(is_left, lower_left, lower_right));
  const V least = hn::Min(hn::Min(upper_left, upper_right), hn::Min(lower_left, lower_right));
  const V most = hn::Max(hn::Max(upper_left, upper_right), hn::Max(lower_left, lower_right));
  // Ranges that differ by this factor belong to different surfaces; 0 is unknown.
  constexpr float kEdgeRatio = 1.15f;
  const auto is_one_surface = hn::Lt(most, hn::Mul(Constant(kEdgeRatio), least));
  const V above = hn::MulAdd(right_fraction, hn::Sub(upper_right, upper_left), upper_left);
  const V below = hn::MulAdd(right_fraction, hn::Sub(lower_right, lower_left), lower_left);
  const V inverse_range = hn::IfThenElse(
      is_one_surface, hn::MulAdd(bottom_fraction, hn::Sub(below, above), above), nearest);

  const VI pixel = hn::Add(hn::Mul(row, width), column);
  const auto words = hn::GatherIndex(du, view.confidence_levels().data(), hn::ShiftRight<2>(pixel));
  const auto byte = hn::BitCast(du, hn::ShiftLeft<3>(hn::And(pixel, hn::Set(di, 3))));
  const auto level = hn::And(hn::Shr(words, byte), hn::Set(du, 255));
  const V confidence = hn::Max(hn::ConvertTo(d, hn::BitCast(di, level)), Constant(0.5f));
  const V error =
      hn::Max(Constant(view.min_error()), hn::Sub(hn::Div(Constant(255), confidence), Constant(1)));
  return {inverse_range, error, row, column};
}

/// The largest 1 / range of a pixel and the eight around it; infinite where one is unknown.
HWY_INLINE V NearestAround(const DepthView& view, VI row, VI column) {
  const D d;
  const DI di;
  const VI width = hn::Set(di, view.width());
  const VI one = hn::Set(di, 1);
  V least = Constant(1e30f);
  V most = hn::Zero(d);
  for (const VI y : {hn::Max(hn::Sub(row, one), hn::Zero(di)), row,
                     hn::Min(hn::Add(row, one), hn::Set(di, view.height() - 1))}) {
    for (const VI x :
         {Wrap(hn::Sub(column, one), width), column, Wrap(hn::Add(column, one), width)}) {
      const V inverse =
          hn::GatherIndex(d, view.inverse_ranges().data(), hn::Add(hn::Mul(y, width), x));
      least = hn::Min(least, inverse);
      most = hn::Max(most, inverse);
    }
  }
  return hn::IfThenElse(hn::Gt(least, hn::Zero(d)), most, hn::Inf(d));
}

struct V3 {
  V x;
  V y;
  V z;
};

HWY_INLINE V3 Rotated(const Eigen::Matrix3f& by, const V3& v) {
  const auto row = [&](int r) HWY_ATTR {
    return hn::MulAdd(Constant(by(r, 0)), v.x,
                      hn::MulAdd(Constant(by(r, 1)), v.y, hn::Mul(Constant(by(r, 2)), v.z)));
  };
  return {row(0), row(1), row(2)};
}

HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE V3 Load3(const std::array<TestedRow::Array, 3>& from, size_t i) {
  const D d;
  return {hn::LoadU(d, from[0].data() + i), hn::LoadU(d, from[1].data() + i),
          hn::LoadU(d, from[2].data() + i)};
}

void CompareWithSourceViewKernel(const SourceView& source, TestedRow* points) {
  const D d;
  const Eigen::Matrix3f rotation =
      source.source_from_reference.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = source.source_from_reference.translation.cast<float>();
  const V tolerance_errors = Constant(static_cast<float>(source.tolerance_errors));
  const V relative_tolerance = Constant(static_cast<float>(source.relative_tolerance));
  const V max_error = Constant(source.max_error);
  const V zero = hn::Zero(d);
  const V one = Constant(1);
  for (size_t i = 0; i < points->size; i += hn::Lanes(d)) {
    const V own_range = hn::LoadU(d, points->range.data() + i);
    const V3 turned = Rotated(rotation, Load3(points->bearing, i));
    const V3 seen{hn::MulAdd(own_range, turned.x, Constant(translation.x())),
                  hn::MulAdd(own_range, turned.y, Constant(translation.y())),
                  hn::MulAdd(own_range, turned.z, Constant(translation.z()))};
    const V range = hn::Max(hn::Sqrt(Dot(seen, seen)), Constant(1e-30f));
    const V inverse_range = hn::Div(one, range);
    const V3 bearing{hn::Mul(inverse_range, seen.x), hn::Mul(inverse_range, seen.y),
                     hn::Mul(inverse_range, seen.z)};
    const Sighting sighting = LookAlong(*source.view, bearing.x, bearing.y, bearing.z);
    const auto is_known = hn::Gt(sighting.inverse_range, zero);
    const V there = hn::Div(one, hn::IfThenElse(is_known, sighting.inverse_range, one));
    const V slant = Dot(bearing, Rotated(rotation, Load3(points->normal, i)));
    const V incidence = hn::Max(hn::Abs(slant), Constant(kMinIncidence));
    const V error = hn::Mul(hn::Mul(there, sighting.error), incidence);
    const V both = hn::Sqrt(hn::MulAdd(error, error, hn::LoadU(d, points->variance.data() + i)));
    const V tolerance =
        hn::MulAdd(tolerance_errors, both, hn::Mul(relative_tolerance, hn::Mul(range, incidence)));
    const V farther = hn::Sub(there, range);
    const V deviation = hn::Mul(farther, incidence);
    const auto agrees = hn::And(is_known, hn::Le(hn::Abs(deviation), tolerance));
    const auto is_certain = hn::Le(error, max_error);
    // A surface that faces away from the source view is another surface at the same place.
    const auto supports =
        hn::And(hn::And(agrees, is_certain), hn::Le(slant, Constant(kMinIncidence)));
    const V information = hn::IfThenElseZero(supports, hn::Div(one, hn::Mul(error, error)));
    const auto add = [&](TestedRow::Array* sum, V more) HWY_ATTR {
      hn::StoreU(hn::Add(hn::LoadU(d, sum->data() + i), more), d, sum->data() + i);
    };
    add(&points->support, hn::IfThenElseZero(supports, one));
    add(&points->information, information);
    add(&points->shift, hn::Mul(information, hn::Mul(farther, slant)));
    float* best = points->best.data() + i;
    hn::StoreU(hn::Max(hn::LoadU(d, best), information), d, best);
    const auto is_through = hn::And(is_known, hn::Gt(deviation, tolerance));
    if (hn::AllFalse(d, is_through)) continue;
    // The nearest of the pixels around decides whether the surface is still behind the point.
    const V nearest = hn::Div(one, NearestAround(*source.view, sighting.row, sighting.column));
    const auto conflicts =
        hn::And(is_through, hn::Gt(hn::Mul(hn::Sub(nearest, range), incidence), tolerance));
    add(&points->conflict, hn::IfThenElseZero(conflicts, one));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(CompareWithSourceViewKernel);

void CompareWithSourceView(const SourceView& source, TestedRow* points) {
  HWY_DYNAMIC_DISPATCH(CompareWithSourceViewKernel)(source, points);
}

}  // namespace orb360
#endif
