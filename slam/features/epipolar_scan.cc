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

void FindOnArc(const BearingColumns& bearings, const EpipolarArc& arc, std::vector<int>* indices) {
  // Component of the epipole across the direction of infinity: the way along the arc.
  const Eigen::Vector3f along =
      (arc.epipole - arc.epipole.dot(arc.infinity) * arc.infinity).normalized().cast<float>();
  const Eigen::Vector3f normal = arc.normal.cast<float>();
  const Eigen::Vector3f infinity = arc.infinity.cast<float>();
  const Eigen::Vector3f epipole = arc.epipole.cast<float>();
  const float variance = static_cast<float>(arc.variance);
  const float squared_sigmas = static_cast<float>(arc.max_sigmas * arc.max_sigmas);
  const float min_cosine = static_cast<float>(std::cos(arc.max_parallax));
  const float max_epipole = static_cast<float>(arc.max_epipole_cosine);

  const hn::CappedTag<float, 16> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int count = bearings.size();
  indices->resize(count);
  int found = 0;
  for (int i = 0; i < count; i += lanes) {
    const auto x = hn::LoadU(d, bearings.x() + i);
    const auto y = hn::LoadU(d, bearings.y() + i);
    const auto z = hn::LoadU(d, bearings.z() + i);
    const auto dot = [&](const Eigen::Vector3f& v) HWY_ATTR {
      return hn::MulAdd(hn::Set(d, v.x()), x,
                        hn::MulAdd(hn::Set(d, v.y()), y, hn::Mul(hn::Set(d, v.z()), z)));
    };
    // One radian around infinity is less than a quarter of the sphere.
    const auto near = hn::Ge(dot(infinity), hn::Set(d, min_cosine));
    if (hn::AllFalse(d, near)) continue;
    const auto both = hn::Add(hn::LoadU(d, bearings.variance() + i), hn::Set(d, variance));
    const auto off_plane = dot(normal);
    const auto near_plane =
        hn::Le(hn::Mul(off_plane, off_plane), hn::Mul(hn::Set(d, squared_sigmas), both));
    if (hn::AllFalse(d, near_plane)) continue;
    // One standard deviation beyond infinity is noise.
    const auto forward = hn::Ge(dot(along), hn::Neg(hn::Sqrt(both)));
    const auto off_epipole = hn::Lt(hn::Abs(dot(epipole)), hn::Set(d, max_epipole));
    const auto mask = hn::And(hn::And(near_plane, forward), hn::And(near, off_epipole));
    if (hn::AllFalse(d, mask)) continue;
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    for (unsigned rest = bits[0] | (bits[1] << 8); rest != 0; rest &= rest - 1) {
      (*indices)[found++] = bearings.index(i + __builtin_ctz(rest));
    }
  }
  indices->resize(found);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {

HWY_EXPORT(FindOnArc);

namespace {

// Cells on the faces of a cube around the sphere, about 20 degrees wide, numbered along each face.
constexpr int kCellsPerEdge = 4;
constexpr int kCells = 6 * kCellsPerEdge * kCellsPerEdge;

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
  constexpr size_t kLongestVector = 16;  // lanes
  const size_t padded = (bearings.size() + kLongestVector - 1) / kLongestVector * kLongestVector;
  for (std::vector<float>* column : {&x_, &y_, &z_, &variance_}) column->resize(padded, 0.0f);
  std::vector<int> cells(bearings.size());
  std::array<int, kCells + 1> next = {};  // position of a cell's next bearing
  for (size_t i = 0; i < bearings.size(); ++i) {
    cells[i] = CellOnCube(bearings[i]);
    ++next[cells[i] + 1];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (size_t i = 0; i < bearings.size(); ++i) {
    const int at = next[cells[i]]++;
    index_[at] = static_cast<int>(i);
    x_[at] = static_cast<float>(bearings[i].x());
    y_[at] = static_cast<float>(bearings[i].y());
    z_[at] = static_cast<float>(bearings[i].z());
    variance_[at] = static_cast<float>(sigmas[i] * sigmas[i]);
  }
}

void FindOnArc(const BearingColumns& bearings, const EpipolarArc& arc, std::vector<int>* indices) {
  HWY_DYNAMIC_DISPATCH(FindOnArc)(bearings, arc, indices);
}

}  // namespace orb360
#endif
