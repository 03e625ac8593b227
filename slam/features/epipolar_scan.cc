#include "slam/features/epipolar_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/features/epipolar_scan.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, BearingColumns::kMaxLanes>;
using V = hn::Vec<D>;

namespace {

struct V3 {
  V x, y, z;
};

HWY_INLINE V Dot(const Eigen::Vector3f& a, const V3& b) {
  const D d;
  return hn::MulAdd(hn::Set(d, a.x()), b.x,
                    hn::MulAdd(hn::Set(d, a.y()), b.y, hn::Mul(hn::Set(d, a.z()), b.z)));
}

/// Returns the set lanes as bits.
HWY_INLINE unsigned Bits(hn::Mask<D> mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return bytes[0] | (bytes[1] << 8);
}

}  // namespace

void FindOnArc(const BearingColumns& bearings, const EpipolarArc& arc, std::vector<int>* indices) {
  // Component of the epipole perpendicular to the direction at infinity, along the arc.
  const Eigen::Vector3f along =
      (arc.epipole - arc.epipole.dot(arc.infinity) * arc.infinity).normalized().cast<float>();
  const Eigen::Vector3f normal = arc.normal.cast<float>();
  const Eigen::Vector3f infinity = arc.infinity.cast<float>();
  const Eigen::Vector3f epipole = arc.epipole.cast<float>();
  const float variance = static_cast<float>(arc.variance);
  const float squared_sigmas = static_cast<float>(arc.max_sigmas * arc.max_sigmas);
  const float min_cosine = static_cast<float>(std::cos(arc.max_parallax));
  const float max_epipole = static_cast<float>(arc.max_epipole_cosine);

  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  // A cell can contain such bearings if its circle reaches the plane and reaches a point within
  // max_parallax of infinity.
  const float margin = std::min(
      1.0F, static_cast<float>(arc.max_sigmas) * std::sqrt(variance + bearings.max_variance()));
  const auto plane_sine = hn::Set(d, margin);
  const auto plane_cosine = hn::Set(d, std::sqrt(1 - margin * margin));
  const auto near_sine = hn::Set(d, static_cast<float>(std::sin(arc.max_parallax)));
  const auto near_cosine = hn::Set(d, min_cosine);
  const BearingColumns::Cells& cells = bearings.cells();
  const int* first = cells.first.data();
  const float* xs = bearings.x();
  const float* ys = bearings.y();
  const float* zs = bearings.z();
  const float* variances = bearings.variance();
  const int num_cells = static_cast<int>(cells.first.size()) - 1;
  indices->clear();
  for (int c = 0; c < num_cells; c += lanes) {
    const V3 center = {hn::LoadU(d, cells.x.data() + c), hn::LoadU(d, cells.y.data() + c),
                       hn::LoadU(d, cells.z.data() + c)};
    const auto sine = hn::LoadU(d, cells.sine.data() + c);
    const auto cosine = hn::LoadU(d, cells.cosine.data() + c);
    const auto is_near =
        hn::Ge(Dot(infinity, center), hn::NegMulAdd(near_sine, sine, hn::Mul(near_cosine, cosine)));
    // Accept all cells if the plane's surroundings and the circle together cover a quarter of the
    // sphere.
    const auto is_on_plane =
        hn::Or(hn::Le(hn::Abs(Dot(normal, center)),
                      hn::MulAdd(plane_cosine, sine, hn::Mul(plane_sine, cosine))),
               hn::Ge(plane_sine, cosine));
    for (unsigned on_arc = Bits(hn::And(is_near, is_on_plane)); on_arc != 0; on_arc &= on_arc - 1) {
      const int cell = c + __builtin_ctz(on_arc);
      for (int i = first[cell]; i < first[cell + 1]; i += lanes) {
        const V3 bearing = {hn::LoadU(d, xs + i), hn::LoadU(d, ys + i), hn::LoadU(d, zs + i)};
        const auto of_cell = hn::FirstN(d, static_cast<size_t>(first[cell + 1] - i));
        // One radian around infinity is less than a quarter of the sphere.
        const auto near = hn::Ge(Dot(infinity, bearing), near_cosine);
        const auto both = hn::Add(hn::LoadU(d, variances + i), hn::Set(d, variance));
        const auto off_plane = Dot(normal, bearing);
        const auto near_plane =
            hn::Le(hn::Mul(off_plane, off_plane), hn::Mul(hn::Set(d, squared_sigmas), both));
        const auto in_band = hn::And(hn::And(near, near_plane), of_cell);
        if (hn::AllFalse(d, in_band)) continue;
        // Noise can move a bearing by one standard deviation beyond infinity.
        const auto forward = hn::Ge(Dot(along, bearing), hn::Neg(hn::Sqrt(both)));
        const auto off_epipole = hn::Lt(hn::Abs(Dot(epipole, bearing)), hn::Set(d, max_epipole));
        const auto is_found = hn::And(in_band, hn::And(forward, off_epipole));
        for (unsigned found = Bits(is_found); found != 0; found &= found - 1) {
          indices->push_back(bearings.index(i + __builtin_ctz(found)));
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(FindOnArc);

namespace {

// Cells lie on the faces of a cube around the sphere; they are about 20 degrees wide and numbered
// along each face.
constexpr int kCellsPerEdge = 4;
constexpr int kCells = 6 * kCellsPerEdge * kCellsPerEdge;
static_assert(kCells % BearingColumns::kMaxLanes == 0);  // vectors of cells hold nothing else

int CellOnCube(const Eigen::Vector3d& bearing) {
  int axis = 0;
  const double longest = bearing.cwiseAbs().maxCoeff(&axis);
  const auto along = [&](int other) {
    const double from_edge = 0.5 * (bearing[other] / longest + 1.0);
    return std::min(static_cast<int>(from_edge * kCellsPerEdge), kCellsPerEdge - 1);
  };
  const int face = 2 * axis + (bearing[axis] < 0 ? 1 : 0);
  return (face * kCellsPerEdge + along((axis + 1) % 3)) * kCellsPerEdge + along((axis + 2) % 3);
}

}  // namespace

BearingColumns::BearingColumns(std::span<const Eigen::Vector3d> bearings,
                               std::span<const double> sigmas)
    : index_(bearings.size()) {
  for (std::vector<float>* column : {&x_, &y_, &z_, &variance_}) {
    column->resize(bearings.size() + kMaxLanes);
  }
  std::vector<int> of_bearing(bearings.size());
  cells_.first.resize(kCells + 1);
  for (size_t i = 0; i < bearings.size(); ++i) {
    of_bearing[i] = CellOnCube(bearings[i]);
    ++cells_.first[of_bearing[i] + 1];
  }
  std::partial_sum(cells_.first.begin(), cells_.first.end(), cells_.first.begin());
  std::vector<int> next = cells_.first;
  for (size_t i = 0; i < bearings.size(); ++i) {
    const int at = next[of_bearing[i]]++;
    index_[at] = static_cast<int>(i);
    x_[at] = static_cast<float>(bearings[i].x());
    y_[at] = static_cast<float>(bearings[i].y());
    z_[at] = static_cast<float>(bearings[i].z());
    variance_[at] = static_cast<float>(sigmas[i] * sigmas[i]);
    max_variance_ = std::max(max_variance_, variance_[at]);
  }
  EncloseCells();
}

void BearingColumns::EncloseCells() {
  constexpr float kRounding = 1e-3F;  // rad
  for (std::vector<float>* column :
       {&cells_.x, &cells_.y, &cells_.z, &cells_.sine, &cells_.cosine}) {
    column->resize(kCells);
  }
  for (int c = 0; c < kCells; ++c) {
    const auto bearing = [this](int i) { return Eigen::Vector3f(x_[i], y_[i], z_[i]); };
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int i = cells_.first[c]; i < cells_.first[c + 1]; ++i) sum += bearing(i);
    const Eigen::Vector3f center = sum.normalized();
    float least_cosine = 1;
    for (int i = cells_.first[c]; i < cells_.first[c + 1]; ++i) {
      least_cosine = std::min(least_cosine, center.dot(bearing(i)));
    }
    const float radius = std::acos(least_cosine) + kRounding;
    cells_.x[c] = center.x();
    cells_.y[c] = center.y();
    cells_.z[c] = center.z();
    cells_.sine[c] = std::sin(radius);
    cells_.cosine[c] = std::cos(radius);
  }
}

void FindOnArc(const BearingColumns& bearings, const EpipolarArc& arc, std::vector<int>* indices) {
  HWY_DYNAMIC_DISPATCH(FindOnArc)(bearings, arc, indices);
}

}  // namespace orb360
#endif
