#include "apps/town/import/walk_path.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/town/import/camera_path.h"
#include "apps/town/import/walk_route.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Distance between the positions of the result, metres.
constexpr double kSpacing = 0.1;
/// The smallest area worth a walk, in cells (2 square metres).
constexpr size_t kLeastPlaces = 50;

/// A point of the way on the floor, and the place whose floor it is.
struct FloorPoint {
  Eigen::Vector2d xy;
  uint32_t place;
};

/// Returns the place to begin at: in the largest component that one of the starts leads into.
uint32_t ChooseStart(const WalkableGrid& grid, const WalkOptions& options, Random* random) {
  const std::vector<uint32_t> component = grid.Components();
  std::vector<size_t> sizes;
  for (const uint32_t c : component) {
    if (c >= sizes.size()) sizes.resize(c + 1, 0);
    ++sizes[c];
  }
  std::vector<uint32_t> candidates;
  constexpr float kAboveFloor = 1.5F;  // metres; players may begin in the air
  for (const Vector3f& start : options.starts) {
    // The neighbourhood is searched, too, because a start may be beside a pillar.
    for (const float r : {0.0F, 0.4F, 0.8F}) {
      for (const auto& [x, y] : kWalkDirections) {
        const Vector3f near = start + r * Vector3f(static_cast<float>(x), static_cast<float>(y), 0);
        const uint32_t place = grid.Find(near, kAboveFloor);
        if (place != kNoPlace) candidates.push_back(place);
      }
    }
  }
  if (options.starts.empty()) {
    candidates.resize(grid.places().size());
    for (uint32_t i = 0; i < candidates.size(); ++i) candidates[i] = i;
  }
  size_t largest = 0;
  for (const uint32_t place : candidates) largest = std::max(largest, sizes[component[place]]);
  if (largest < kLeastPlaces) {
    throw UserError(options.starts.empty()
                        ? "nobody can walk here: there is no floor with head room (see --scale, "
                          "--up and --height)"
                        : "nobody can walk from the start: there is no floor with head room (see "
                          "--start, --scale, --up and --height)");
  }
  std::vector<uint32_t> best;
  for (const uint32_t place : candidates)
    if (sizes[component[place]] == largest) best.push_back(place);
  std::vector<uint32_t> clear;
  for (const uint32_t place : best) {
    if (grid.places()[place].clearance >= static_cast<float>(options.size.clearance))
      clear.push_back(place);
  }
  return random->Pick(std::span<const uint32_t>(clear.empty() ? best : clear));
}

/// Returns a lower bound of the distance to what is not free: that of the middle of the cell less
/// the distance from there.
double ClearanceAt(const WalkableGrid& grid, const FloorPoint& point) {
  const Eigen::Vector2d middle = grid.PositionOf(point.place).head<2>().cast<double>();
  return grid.places()[point.place].clearance - (point.xy - middle).norm();
}

/// Moves the points of a way towards the middle of their neighbours, so long as they keep their
/// clearance, and stay on floors that steps lead to. The points `held` stay.
void Smooth(const WalkableGrid& grid, const WalkerSize& size, const std::vector<bool>& held,
            std::vector<FloorPoint>* way) {
  constexpr int kRounds = 60;  // the way bends over about sqrt(60) points to both sides
  for (int round = 0; round < kRounds; ++round) {
    for (size_t i = 1; i + 1 < way->size(); ++i) {
      if (held[i]) continue;
      FloorPoint& point = (*way)[i];
      const Eigen::Vector2d moved = 0.5 * point.xy + 0.25 * ((*way)[i - 1].xy + (*way)[i + 1].xy);
      const float floor = grid.places()[point.place].floor;
      const Vector3f target(static_cast<float>(moved.x()), static_cast<float>(moved.y()), floor);
      const uint32_t place = grid.Find(target, static_cast<float>(size.step));
      if (place == kNoPlace) continue;
      const Standing& old = grid.places()[point.place];
      const bool is_step = place == point.place ||
                           std::find(old.next.begin(), old.next.end(), place) != old.next.end();
      const double wanted = std::min(size.clearance, ClearanceAt(grid, point));
      if (!is_step || ClearanceAt(grid, {moved, place}) < wanted) continue;
      point = {moved, place};
    }
  }
}

/// Returns positions of the camera in even distances along a way, with the height smoothed.
std::vector<Eigen::Vector3d> CameraPositions(const WalkableGrid& grid, const WalkOptions& options,
                                             const std::vector<FloorPoint>& way) {
  std::vector<double> along = {0};
  for (size_t i = 1; i < way.size(); ++i)
    along.push_back(along.back() + (way[i].xy - way[i - 1].xy).norm());
  // The weights of heights fall to nothing within this distance along the way.
  constexpr double kReach = 0.8;
  const auto height_at = [&](double s) {
    double sum = 0;
    double weights = 0;
    const auto first = std::lower_bound(along.begin(), along.end(), s - kReach);
    for (auto i = static_cast<size_t>(first - along.begin());
         i < along.size() && along[i] <= s + kReach; ++i) {
      const double weight = std::pow(1.0001 - std::pow((along[i] - s) / kReach, 2), 2);
      sum += weight * grid.places()[way[i].place].floor;
      weights += weight;
    }
    return sum / weights;
  };
  std::vector<Eigen::Vector3d> positions;
  size_t i = 0;
  for (double s = 0; s <= std::min(options.length + 1e-9, along.back()); s += kSpacing) {
    while (i + 2 < along.size() && along[i + 1] < s) ++i;
    const double t = std::clamp((s - along[i]) / std::max(along[i + 1] - along[i], 1e-9), 0.0, 1.0);
    const Eigen::Vector2d xy = (1 - t) * way[i].xy + t * way[i + 1].xy;
    positions.emplace_back(xy.x(), xy.y(), height_at(s) + options.size.camera_height);
  }
  return positions;
}

/// Returns the index of the first position after which the camera meets a surface.
std::optional<size_t> FirstCollision(const RayScene& scene,
                                     const std::vector<Eigen::Vector3d>& positions) {
  for (size_t i = 0; i + 1 < positions.size(); ++i) {
    const Vector3f from = positions[i].cast<float>();
    if (!IsFree(scene, from, positions[i + 1].cast<float>())) return i;
  }
  return std::nullopt;
}

}  // namespace

Walk WalkThrough(const RayScene& scene, const Eigen::AlignedBox3f& box,
                 const WalkOptions& options) {
  const WalkableGrid grid(scene, box, options.is_floor, options.size);
  Random random(options.seed);
  const uint32_t start = ChooseStart(grid, options, &random);
  // Smoothing shortens a way; bends of the grid make it at most 8 % longer than a straight line.
  const double route_length = 1.25 * options.length + 2;
  const std::vector<uint32_t> route =
      FindRoute(grid, start, options.size.clearance, route_length, &random);
  if (route.empty()) throw UserError("nobody can walk from the start: no step leads away from it");
  std::vector<FloorPoint> raw;
  for (const uint32_t place : route)
    raw.push_back({grid.PositionOf(place).head<2>().cast<double>(), place});

  std::vector<bool> held(raw.size(), false);
  constexpr int kTries = 50;
  for (int k = 0; k < kTries; ++k) {
    std::vector<FloorPoint> way = raw;
    Smooth(grid, options.size, held, &way);
    std::vector<Eigen::Vector3d> positions = CameraPositions(grid, options, way);
    const std::optional<size_t> collision = FirstCollision(scene, positions);
    if (!collision) return {std::move(positions), kSpacing};
    // The way stays on the middles of cells around a collision.
    constexpr double kAround = 1.5;  // metres
    const Eigen::Vector2d there = positions[*collision].head<2>();
    for (size_t i = 0; i < raw.size(); ++i)
      if ((way[i].xy - there).norm() < kAround) held[i] = true;
  }
  throw UserError("no way was found that the camera can take without meeting a surface");
}

}  // namespace orb360::town
