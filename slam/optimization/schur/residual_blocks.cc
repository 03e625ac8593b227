#include "slam/optimization/schur/residual_blocks.h"

#include <cstddef>
#include <cstdint>

#include "slam/optimization/point_residual.h"
#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/schur/residual_blocks.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One residual block in each lane.
using D = hn::CappedTag<double, kMaxLanes>;
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

// One row of a residual and its derivative by the point in the camera frame.
struct Row {
  V residual;
  V3 by_camera_point;
};

// Calls visit(index, row) for each row of the residuals of the blocks from `at` on, one vector.
template <typename Visit>
HWY_INLINE void ForEachRow(const ResidualBlocks& blocks, size_t at, const V3& camera_point,
                           const Visit& visit) {
  const D d;
  const auto constant = [&](size_t column)
                            HWY_ATTR { return hn::LoadU(d, blocks.constants[column].data() + at); };
  const V one = hn::Set(d, 1.0);
  switch (blocks.kind) {
    case ResidualBlocks::kDirection: {
      const V inverse_range = hn::Div(one, hn::Sqrt(Dot(camera_point, camera_point)));
      const V3 unit = Scaled(camera_point, inverse_range);
      for (size_t i = 0; i < 2; ++i) {
        const V3 basis = {constant(3 * i), constant(3 * i + 1), constant(3 * i + 2)};
        const V residual = Dot(basis, unit);
        const V3 across = {hn::NegMulAdd(residual, unit.x, basis.x),
                           hn::NegMulAdd(residual, unit.y, basis.y),
                           hn::NegMulAdd(residual, unit.z, basis.z)};
        visit(i, Row{residual, Scaled(across, inverse_range)});
      }
      break;
    }
    case ResidualBlocks::kHeight: {
      const V3 direction = {constant(0), constant(1), constant(2)};
      visit(size_t{0}, Row{hn::Sub(Dot(direction, camera_point), constant(3)), direction});
      break;
    }
    case ResidualBlocks::kRange: {
      const V squared = Dot(camera_point, camera_point);
      // Highway's logarithms of zero and infinity are numbers.
      const auto is_finite = hn::And(hn::Gt(squared, hn::Zero(d)), hn::Lt(squared, hn::Inf(d)));
      const V log_squared = hn::IfThenElse(is_finite, hn::Log(d, squared), hn::Inf(d));
      const V log_range = hn::Mul(hn::Set(d, 0.5), log_squared);
      const V residual = hn::Mul(constant(1), hn::Sub(log_range, constant(0)));
      visit(size_t{0}, Row{residual, Scaled(camera_point, hn::Div(constant(1), squared))});
      break;
    }
  }
}

}  // namespace

void EvaluateResidualBlocks(const ResidualBlocks& blocks, size_t begin, const PackedState& state,
                            double* squared_norms, size_t size, JacobianRow* rows) {
  const D d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  const auto stride =
      static_cast<std::int64_t>(blocks.num_rows() * sizeof(JacobianRow) / sizeof(double));
  const auto row_index = hn::Mul(hn::Iota(di, 0), hn::Set(di, stride));
  HWY_ALIGN std::int64_t pose_start[kMaxLanes];
  HWY_ALIGN std::int64_t point_start[kMaxLanes];
  for (size_t i = 0; i < size; i += lanes) {
    for (size_t lane = 0; lane < lanes; ++lane) {
      // Lanes past the end repeat a block; their results are not used.
      const size_t block = begin + i + lane < blocks.size ? begin + i + lane : begin;
      pose_start[lane] = 12 * std::int64_t{blocks.pose[block]};
      point_start[lane] = 3 * std::int64_t{blocks.point[block]};
    }
    const auto pose_index = hn::Load(di, pose_start);
    const auto point_index = hn::Load(di, point_start);
    const auto pose = [&](size_t k) HWY_ATTR {
      return hn::GatherIndex(d, state.poses.data() + k, pose_index);
    };
    const auto point = [&](size_t k) HWY_ATTR {
      return hn::GatherIndex(d, state.points.data() + k, point_index);
    };
    const V3 world = {point(0), point(1), point(2)};
    const V3 x = {pose(0), pose(1), pose(2)};
    const V3 y = {pose(4), pose(5), pose(6)};
    const V3 z = {pose(8), pose(9), pose(10)};
    const V3 camera_point = {hn::Add(Dot(x, world), pose(3)), hn::Add(Dot(y, world), pose(7)),
                             hn::Add(Dot(z, world), pose(11))};
    V sum = hn::Zero(d);
    ForEachRow(blocks, begin + i, camera_point, [&](size_t number, const Row& row) HWY_ATTR {
      sum = hn::MulAdd(row.residual, row.residual, sum);
      if (rows == nullptr) return;
      // A rotation by w moves the point by w x p, so the row g by p gives p x g by w.
      const V3& g = row.by_camera_point;
      const V3 by_rotation = Cross(camera_point, g);
      const V3 by_point = {hn::MulAdd(g.x, x.x, hn::MulAdd(g.y, y.x, hn::Mul(g.z, z.x))),
                           hn::MulAdd(g.x, x.y, hn::MulAdd(g.y, y.y, hn::Mul(g.z, z.y))),
                           hn::MulAdd(g.x, x.z, hn::MulAdd(g.y, y.z, hn::Mul(g.z, z.z)))};
      auto* out = reinterpret_cast<double*>(&rows[i * blocks.num_rows() + number]);
      const V zero = hn::Zero(d);
      const V columns[] = {by_rotation.x, by_rotation.y, by_rotation.z, g.x,
                           g.y,           g.z,           zero,          zero,
                           by_point.x,    by_point.y,    by_point.z,    row.residual};
      for (const V& column : columns) hn::ScatterIndex(column, d, out++, row_index);
    });
    hn::StoreU(sum, d, squared_norms + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(EvaluateResidualBlocks);

// EvaluateResidualBlocks writes rows as arrays of twelve numbers.
static_assert(sizeof(JacobianRow) == 12 * sizeof(double));
static_assert(offsetof(JacobianRow, by_pose) == 0);
static_assert(offsetof(JacobianRow, by_point) == 8 * sizeof(double));
static_assert(offsetof(JacobianRow, residual) == 11 * sizeof(double));

template <typename Measurement>
ResidualBlocks MakeBlocks(ResidualBlocks::Kind kind, const std::vector<Measurement>& measurements) {
  ResidualBlocks blocks;
  blocks.kind = kind;
  blocks.size = measurements.size();
  for (const Measurement& measurement : measurements) {
    blocks.pose.push_back(measurement.pose);
    blocks.point.push_back(measurement.point);
  }
  blocks.pair.assign(blocks.size, -1);
  return blocks;
}

template <typename Numbers>
void AppendConstants(const Numbers& numbers, ResidualBlocks* blocks) {
  size_t column = 0;
  for (const double number : numbers) blocks->constants[column++].push_back(number);
}

}  // namespace

std::array<ResidualBlocks, 3> MakeResidualBlocks(const BundleProblem& problem) {
  std::array<ResidualBlocks, 3> all = {MakeBlocks(ResidualBlocks::kDirection, problem.observations),
                                       MakeBlocks(ResidualBlocks::kHeight, problem.heights),
                                       MakeBlocks(ResidualBlocks::kRange, problem.ranges)};
  for (const BundleProblem::Observation& o : problem.observations) {
    AppendConstants(DirectionResidual(o.bearing, o.sigma).scaled_basis.reshaped(), &all[0]);
  }
  for (const BundleProblem::Height& h : problem.heights) {
    const HeightResidual residual(h.normal, h.height, h.sigma);
    const Eigen::Vector3d& n = residual.direction;
    AppendConstants(std::array{n.x(), n.y(), n.z(), residual.offset}, &all[1]);
  }
  for (const BundleProblem::Range& r : problem.ranges) {
    const RangeResidual residual(r.range, r.sigma);
    AppendConstants(std::array{residual.log_range, residual.weight}, &all[2]);
  }
  for (ResidualBlocks& blocks : all) {
    for (std::vector<double>& column : blocks.constants) {
      column.resize((column.size() + kMaxLanes - 1) / kMaxLanes * kMaxLanes);
    }
  }
  return all;
}

void EvaluateResidualBlocks(const ResidualBlocks& blocks, size_t begin, const PackedState& state,
                            std::span<double> squared_norms, std::span<JacobianRow> rows) {
  ORB360_CHECK(squared_norms.size() % kMaxLanes == 0 &&
                   begin + squared_norms.size() < blocks.size + kMaxLanes,
               squared_norms.size(), begin, blocks.size);
  HWY_DYNAMIC_DISPATCH(EvaluateResidualBlocks)
  (blocks, begin, state, squared_norms.data(), squared_norms.size(),
   rows.empty() ? nullptr : rows.data());
}

}  // namespace orb360
#endif
