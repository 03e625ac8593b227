#include "slam/optimization/bundle_terms.h"

#include <cstddef>
#include <cstdint>

#include "nn/base/check.h"
#include "slam/optimization/point_residual.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/bundle_terms.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One term in each lane.
using D = hn::CappedTag<double, kMostTerms>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;

namespace {

struct V3 {
  V x, y, z;
};

HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE V3 Scaled(const V3& a, V factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

// A residual of one row, and its derivative by the point in the camera's frame.
struct Row {
  V residual;
  V3 by_seen;
};

// Calls take(row's number, row) for each row of the terms' residuals.
template <typename Take>
HWY_INLINE void ForEachRow(const BundleTerms& terms, size_t at, const V3& seen, const Take& take) {
  const D d;
  const auto known = [&](size_t column)
                         HWY_ATTR { return hn::LoadU(d, terms.known[column].data() + at); };
  const V one = hn::Set(d, 1.0);
  switch (terms.kind) {
    case BundleTerms::kDirection: {
      const V inverse_range = hn::Div(one, hn::Sqrt(Dot(seen, seen)));
      const V3 unit = Scaled(seen, inverse_range);
      for (size_t i = 0; i < 2; ++i) {
        const V3 basis = {known(3 * i), known(3 * i + 1), known(3 * i + 2)};
        const V residual = Dot(basis, unit);
        const V3 across = {hn::NegMulAdd(residual, unit.x, basis.x),
                           hn::NegMulAdd(residual, unit.y, basis.y),
                           hn::NegMulAdd(residual, unit.z, basis.z)};
        take(i, Row{residual, Scaled(across, inverse_range)});
      }
      break;
    }
    case BundleTerms::kHeight: {
      const V3 direction = {known(0), known(1), known(2)};
      take(size_t{0}, Row{hn::Sub(Dot(direction, seen), known(3)), direction});
      break;
    }
    case BundleTerms::kRange: {
      const V squared = Dot(seen, seen);
      // Highway's logarithms of zero and infinity are numbers.
      const auto is_finite = hn::And(hn::Gt(squared, hn::Zero(d)), hn::Lt(squared, hn::Inf(d)));
      const V log_squared = hn::IfThenElse(is_finite, hn::Log(d, squared), hn::Inf(d));
      const V log_range = hn::Mul(hn::Set(d, 0.5), log_squared);
      const V residual = hn::Mul(known(1), hn::Sub(log_range, known(0)));
      take(size_t{0}, Row{residual, Scaled(seen, hn::Div(known(1), squared))});
      break;
    }
  }
}

}  // namespace

void EvaluateTerms(const BundleTerms& terms, size_t begin, const BundlePlaces& places,
                   double* squared, size_t size, TermRow* rows) {
  const D d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  const auto stride =
      static_cast<std::int64_t>(terms.num_rows() * sizeof(TermRow) / sizeof(double));
  const auto row_index = hn::Mul(hn::Iota(di, 0), hn::Set(di, stride));
  HWY_ALIGN std::int64_t pose_start[kMostTerms];
  HWY_ALIGN std::int64_t point_start[kMostTerms];
  for (size_t i = 0; i < size; i += lanes) {
    for (size_t lane = 0; lane < lanes; ++lane) {
      // Past the end any pose and point will do.
      const size_t term = begin + i + lane < terms.size ? begin + i + lane : begin;
      pose_start[lane] = 12 * std::int64_t{terms.pose[term]};
      point_start[lane] = 3 * std::int64_t{terms.point[term]};
    }
    const auto pose_index = hn::Load(di, pose_start);
    const auto point_index = hn::Load(di, point_start);
    const auto pose = [&](size_t k) HWY_ATTR {
      return hn::GatherIndex(d, places.poses.data() + k, pose_index);
    };
    const auto point = [&](size_t k) HWY_ATTR {
      return hn::GatherIndex(d, places.points.data() + k, point_index);
    };
    const V3 world = {point(0), point(1), point(2)};
    const V3 x = {pose(0), pose(1), pose(2)};
    const V3 y = {pose(4), pose(5), pose(6)};
    const V3 z = {pose(8), pose(9), pose(10)};
    const V3 seen = {hn::Add(Dot(x, world), pose(3)), hn::Add(Dot(y, world), pose(7)),
                     hn::Add(Dot(z, world), pose(11))};
    V sum = hn::Zero(d);
    ForEachRow(terms, begin + i, seen, [&](size_t number, const Row& row) HWY_ATTR {
      sum = hn::MulAdd(row.residual, row.residual, sum);
      if (rows == nullptr) return;
      // Turning the camera's frame by w moves the point by w x seen.
      const V3 by_turn = Cross(seen, row.by_seen);
      const V3 by_point = {hn::MulAdd(row.by_seen.x, x.x,
                                      hn::MulAdd(row.by_seen.y, y.x, hn::Mul(row.by_seen.z, z.x))),
                           hn::MulAdd(row.by_seen.x, x.y,
                                      hn::MulAdd(row.by_seen.y, y.y, hn::Mul(row.by_seen.z, z.y))),
                           hn::MulAdd(row.by_seen.x, x.z,
                                      hn::MulAdd(row.by_seen.y, y.z, hn::Mul(row.by_seen.z, z.z)))};
      auto* out = reinterpret_cast<double*>(&rows[i * terms.num_rows() + number]);
      const V zero = hn::Zero(d);
      const V columns[] = {by_turn.x,     by_turn.y,     by_turn.z,  row.by_seen.x,
                           row.by_seen.y, row.by_seen.z, zero,       zero,
                           by_point.x,    by_point.y,    by_point.z, row.residual};
      for (const V& column : columns) hn::ScatterIndex(column, d, out++, row_index);
    });
    hn::StoreU(sum, d, squared + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(EvaluateTerms);

// Rows are filled as arrays of twelve numbers.
static_assert(sizeof(TermRow) == 12 * sizeof(double));
static_assert(offsetof(TermRow, by_pose) == 0);
static_assert(offsetof(TermRow, by_point) == 8 * sizeof(double));
static_assert(offsetof(TermRow, residual) == 11 * sizeof(double));

template <typename Terms>
BundleTerms Located(BundleTerms::Kind kind, const Terms& of_problem) {
  BundleTerms terms;
  terms.kind = kind;
  terms.size = of_problem.size();
  for (const auto& term : of_problem) {
    terms.pose.push_back(term.pose);
    terms.point.push_back(term.point);
  }
  terms.link.assign(terms.size, -1);
  return terms;
}

template <typename Numbers>
void Append(const Numbers& numbers, BundleTerms* terms) {
  size_t column = 0;
  for (const double number : numbers) terms->known[column++].push_back(number);
}

}  // namespace

std::array<BundleTerms, 3> MakeBundleTerms(const BundleProblem& problem) {
  std::array<BundleTerms, 3> all = {Located(BundleTerms::kDirection, problem.observations),
                                    Located(BundleTerms::kHeight, problem.heights),
                                    Located(BundleTerms::kRange, problem.ranges)};
  for (const auto& o : problem.observations) {
    Append(DirectionResidual(o.bearing, o.sigma).scaled_basis.reshaped(), &all[0]);
  }
  for (const auto& h : problem.heights) {
    const HeightResidual residual(h.normal, h.height, h.sigma);
    const Eigen::Vector3d& n = residual.direction;
    Append(std::array{n.x(), n.y(), n.z(), residual.offset}, &all[1]);
  }
  for (const auto& r : problem.ranges) {
    const RangeResidual residual(r.range, r.sigma);
    Append(std::array{residual.log_range, residual.weight}, &all[2]);
  }
  for (BundleTerms& terms : all) {
    for (std::vector<double>& column : terms.known) {
      column.resize((column.size() + kMostTerms - 1) / kMostTerms * kMostTerms);
    }
  }
  return all;
}

void EvaluateTerms(const BundleTerms& terms, size_t begin, const BundlePlaces& places,
                   std::span<double> squared, std::span<TermRow> rows) {
  ORB360_CHECK(squared.size() % kMostTerms == 0 && begin + squared.size() < terms.size + kMostTerms,
               squared.size(), begin, terms.size);
  HWY_DYNAMIC_DISPATCH(EvaluateTerms)
  (terms, begin, places, squared.data(), squared.size(), rows.empty() ? nullptr : rows.data());
}

}  // namespace orb360
#endif
