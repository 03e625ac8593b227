#include "apps/town/import/walkable_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr int kMaxFloors = 64;       // surfaces on one vertical line
constexpr float kApart = 1e-3F;      // metres; surfaces closer together are one
constexpr float kSteepest = 0.707F;  // cosine of 45 degrees
/// A person is at least so far from walls, metres.
constexpr float kLeastClearance = 0.15F;

/// A surface on a vertical line.
struct Level {
  float z;
  bool is_floor;
  bool is_liquid;
};

/// Returns the surfaces below the points (x + i * cell, y) for the lanes of a packet, from above.
std::array<std::vector<Level>, kPacket> LevelsBelow(const FrameScene& scene, float x, float y,
                                                    int lanes, const Eigen::AlignedBox3f& box,
                                                    const std::vector<bool>& is_floor) {
  std::array<std::vector<Level>, kPacket> levels;
  std::array<float, kPacket> top;
  top.fill(box.max().z());
  alignas(64) std::array<int, kPacket> valid{};
  std::fill_n(valid.begin(), lanes, -1);
  bool goes_on = true;
  for (int round = 0; round < kMaxFloors && goes_on; ++round) {
    RTCRayHit16 rays{};
    std::fill_n(rays.ray.tfar, kPacket, -1.0F);
    std::fill_n(rays.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(&rays.hit.instID[0][0], kPacket, RTC_INVALID_GEOMETRY_ID);
    for (int lane = 0; lane < lanes; ++lane) {
      const auto i = static_cast<size_t>(lane);
      if (valid[i] == 0) continue;
      const Vector3f from(x + static_cast<float>(lane) * WalkableGrid::kCell, y, top[i]);
      SetRay(rays.ray, lane, from, -Vector3f::UnitZ(), top[i] - box.min().z());
    }
    scene.Intersect(valid.data(), &rays);
    goes_on = false;
    for (int lane = 0; lane < lanes; ++lane) {
      const auto i = static_cast<size_t>(lane);
      if (valid[i] == 0) continue;
      if (rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
        valid[i] = 0;
        continue;
      }
      const Vector3f normal = scene.GeometricNormal(rays.hit, lane);
      const size_t material = scene.Resolve(rays.hit, lane).triangle->material;
      const bool is_flat = std::abs(normal.z()) >= kSteepest * normal.norm();
      const float z = top[i] - rays.ray.tfar[lane];
      const bool is_liquid = material < is_floor.size() && !is_floor[material];
      levels[i].push_back({z, is_flat && !is_liquid, is_liquid});
      top[i] = z - kApart;
      goes_on = true;
    }
  }
  return levels;
}

/// Returns the distances from a point to the nearest surfaces in 16 horizontal directions,
/// counter-clockwise from +x, at most kFarClearance.
std::array<float, kPacket> FreeAround(const RayScene& scene, const Vector3f& point) {
  // Rays begin behind the point, so that they meet a surface that the point lies on.
  constexpr float kBehind = 0.02F;  // metres
  RTCRayHit16 rays{};
  alignas(64) std::array<int, kPacket> valid;
  valid.fill(-1);
  for (int lane = 0; lane < kPacket; ++lane) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(lane) / kPacket;
    const Vector3f direction(std::cos(angle), std::sin(angle), 0);
    SetRay(rays.ray, lane, point - kBehind * direction, direction, kBehind + kFarClearance);
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  }
  scene.Intersect(valid.data(), &rays);
  std::array<float, kPacket> free;
  for (size_t i = 0; i < free.size(); ++i) free[i] = std::max(rays.ray.tfar[i] - kBehind, 0.0F);
  return free;
}

float StepLength(size_t direction) {
  return WalkableGrid::kCell * (direction % 2 == 0 ? 1.0F : std::numbers::sqrt2_v<float>);
}

}  // namespace

WalkableGrid::WalkableGrid(const RayScene& scene, const Eigen::AlignedBox3f& box,
                           const std::vector<bool>& is_floor, const WalkerSize& size)
    : box_(box) {
  constexpr double kMaxCells = 25e6;
  const Eigen::Vector2d cells =
      ((box.max() - box.min()).head<2>().cast<double>() / kCell).array().ceil().max(1);
  if (!(cells.prod() <= kMaxCells)) {
    throw UserError(
        "the scene is too large to look for a way in all of it: say where to --start, "
        "and ask for a short --length");
  }
  columns_ = static_cast<int>(cells.x());
  rows_ = static_cast<int>(cells.y());
  FindFloors(FrameScene(scene, {}), is_floor, size);
  Connect(scene, size);
  SpreadClearance();
}

void WalkableGrid::FindFloors(const FrameScene& scene, const std::vector<bool>& is_floor,
                              const WalkerSize& size) {
  const auto room = static_cast<float>(size.camera_height + size.head_room);
  std::vector<std::vector<Standing>> found(static_cast<size_t>(rows_));
#pragma omp parallel for schedule(dynamic, 4)
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; column += kPacket) {
      const float x = box_.min().x() + (static_cast<float>(column) + 0.5F) * kCell;
      const float y = box_.min().y() + (static_cast<float>(row) + 0.5F) * kCell;
      const int lanes = std::min(kPacket, columns_ - column);
      const auto levels = LevelsBelow(scene, x, y, lanes, box_, is_floor);
      for (int lane = 0; lane < lanes; ++lane) {
        float above = std::numeric_limits<float>::max();
        bool is_under_liquid = false;
        for (const Level& level : levels[static_cast<size_t>(lane)]) {
          if (level.is_floor && !is_under_liquid && above - level.z >= room) {
            Standing& place = found[static_cast<size_t>(row)].emplace_back();
            place.column = column + lane;
            place.row = row;
            place.floor = level.z;
          }
          above = level.z;
          is_under_liquid = level.is_liquid;
        }
      }
    }
  }
  first_in_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
  for (const std::vector<Standing>& row : found) {
    for (const Standing& place : row) {
      ++first_in_[static_cast<size_t>(place.row) * static_cast<size_t>(columns_) +
                  static_cast<size_t>(place.column) + 1];
      places_.push_back(place);
    }
  }
  for (size_t i = 1; i < first_in_.size(); ++i) first_in_[i] += first_in_[i - 1];
}

void WalkableGrid::Connect(const RayScene& scene, const WalkerSize& size) {
  const auto count = static_cast<std::ptrdiff_t>(places_.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    Standing& place = places_[static_cast<size_t>(i)];
    const Vector3f foot = PositionOf(static_cast<uint32_t>(i));
    std::array<float, kPacket> free;
    free.fill(kFarClearance);
    // Above the highest step, so that stairs are no walls.
    const auto height = static_cast<float>(size.camera_height);
    const auto lowest = static_cast<float>(size.step) + 0.05F;
    for (int k = 0; k <= 4; ++k) {
      const float z = lowest + static_cast<float>(k) / 4 * (height - lowest);
      const auto at_height = FreeAround(scene, foot + z * Vector3f::UnitZ());
      for (size_t d = 0; d < free.size(); ++d) free[d] = std::min(free[d], at_height[d]);
    }
    place.clearance = *std::min_element(free.begin(), free.end());
    const bool fits = place.clearance >= kLeastClearance;
    for (size_t d = 0; d < 8; ++d) {
      place.next[d] = kNoPlace;
      if (free[2 * d] <= StepLength(d)) continue;
      const auto [x, y] = kWalkDirections[d];
      const Vector3f way(static_cast<float>(x), static_cast<float>(y), 0);
      const uint32_t there = Find(foot + kCell * way, static_cast<float>(size.step));
      if (there == kNoPlace) place.clearance = std::min(place.clearance, kCell / 2);  // a drop
      if (fits) place.next[d] = there;
    }
  }
  // A step counts if it is free in both directions. The other direction is read from a copy, so
  // that the order does not matter.
  const std::vector<Standing> before = places_;
  for (uint32_t i = 0; i < places_.size(); ++i) {
    for (size_t d = 0; d < 8; ++d) {
      const uint32_t there = before[i].next[d];
      if (there != kNoPlace && before[there].next[d ^ 4U] != i) places_[i].next[d] = kNoPlace;
    }
  }
}

void WalkableGrid::SpreadClearance() {
  // What is near to one place is not much farther from the next (Dijkstra 1959).
  using Entry = std::pair<float, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (uint32_t i = 0; i < places_.size(); ++i) open.emplace(places_[i].clearance, i);
  while (!open.empty()) {
    const auto [so_far, i] = open.top();
    open.pop();
    if (so_far > places_[i].clearance) continue;
    for (size_t d = 0; d < 8; ++d) {
      const uint32_t there = places_[i].next[d];
      if (there == kNoPlace || so_far + StepLength(d) >= places_[there].clearance) continue;
      places_[there].clearance = so_far + StepLength(d);
      open.emplace(places_[there].clearance, there);
    }
  }
}

Vector3f WalkableGrid::PositionOf(uint32_t place) const {
  const Standing& p = places_[place];
  return {box_.min().x() + (static_cast<float>(p.column) + 0.5F) * kCell,
          box_.min().y() + (static_cast<float>(p.row) + 0.5F) * kCell, p.floor};
}

uint32_t WalkableGrid::Find(const Vector3f& point, float tolerance) const {
  const Vector3f cell = ((point - box_.min()) / kCell).array().floor();
  if (!(cell.x() >= 0 && cell.y() >= 0 && cell.x() < static_cast<float>(columns_) &&
        cell.y() < static_cast<float>(rows_)))
    return kNoPlace;
  const size_t index =
      static_cast<size_t>(cell.y()) * static_cast<size_t>(columns_) + static_cast<size_t>(cell.x());
  uint32_t best = kNoPlace;
  float nearest = tolerance;
  for (uint32_t i = first_in_[index]; i < first_in_[index + 1]; ++i) {
    const float difference = std::abs(places_[i].floor - point.z());
    if (difference > nearest) continue;
    nearest = difference;
    best = i;
  }
  return best;
}

std::vector<uint32_t> WalkableGrid::Components() const {
  std::vector<uint32_t> component(places_.size(), kNoPlace);
  std::vector<uint32_t> open;
  uint32_t count = 0;
  for (uint32_t seed = 0; seed < places_.size(); ++seed) {
    if (component[seed] != kNoPlace) continue;
    component[seed] = count;
    open.push_back(seed);
    while (!open.empty()) {
      const uint32_t i = open.back();
      open.pop_back();
      for (const uint32_t there : places_[i].next) {
        if (there == kNoPlace || component[there] != kNoPlace) continue;
        component[there] = count;
        open.push_back(there);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace orb360::town
