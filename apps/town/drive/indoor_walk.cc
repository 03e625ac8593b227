#include "apps/town/drive/indoor_walk.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "apps/town/world/interior/free_space.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr size_t kFewestCells = 20;  // of a room that is entered

/// Returns the cells of each room that can be reached; rooms with few are left out.
std::vector<std::vector<FreeSpace::Cell>> CellsByRoom(const FloorPlan& plan,
                                                      const FreeSpace& space) {
  std::vector<std::vector<FreeSpace::Cell>> cells(plan.rooms.size());
  for (const FreeSpace::Cell cell : space.reachable()) {
    for (size_t i = 0; i < plan.rooms.size(); ++i) {
      if (plan.rooms[i].area.Contains(space.Middle(cell))) cells[i].push_back(cell);
    }
  }
  std::erase_if(cells, [](const auto& list) { return list.size() < kFewestCells; });
  return cells;
}

/// Returns a way through the cells, at least `length` metres long.
std::vector<Vector2f> PlanRoute(const FloorPlan& plan, const FreeSpace& space, double length,
                                Random& random) {
  const auto rooms = CellsByRoom(plan, space);
  ORB360_CHECK(!rooms.empty(), plan.rooms.size());
  std::vector<size_t> order(rooms.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Vector2f> route;
  double walked = 0;
  auto here = random.Pick(std::span<const FreeSpace::Cell>(rooms[0]));
  while (walked < length) {
    for (size_t i = order.size() - 1; i > 0; --i)
      std::swap(order[i], order[static_cast<size_t>(random.Int(static_cast<int>(i) + 1))]);
    for (const size_t room : order) {
      for (int stops = 1 + random.Int(2); stops > 0; --stops) {
        const auto to = random.Pick(std::span<const FreeSpace::Cell>(rooms[room]));
        for (const FreeSpace::Cell cell : space.Path(here, to)) {
          if (!route.empty()) walked += (space.Middle(cell) - route.back()).norm();
          route.push_back(space.Middle(cell));
        }
        here = to;
      }
    }
  }
  return route;
}

/// Moves points towards the middle of their neighbours as long as they stay clear of obstacles.
void Smooth(const FreeSpace& space, std::vector<Vector2f>* points) {
  constexpr int kRounds = 60;
  constexpr float kKept = IndoorWalk::kClearance + 0.03F;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Vector2f> last = *points;
    for (size_t i = 1; i + 1 < points->size(); ++i) {
      const size_t reach = std::min<size_t>({4, i, points->size() - 1 - i});
      const Vector2f middle = 0.5F * (last[i - reach] + last[i + reach]);
      const Vector2f moved = 0.5F * (last[i] + middle);
      if ((moved - last[i]).squaredNorm() > 1e-8F && space.Clearance(moved) >= kKept)
        (*points)[i] = moved;
    }
  }
}

RouteWalk PlanWalk(const FloorPlan& plan, const FreeSpace& space, const WalkOptions& options,
                   const Random& random) {
  // Bends and smoothing make a route shorter in time than it was planned; then a longer one is.
  double length = 1.1 * options.speed * options.duration + 5;  // metres
  while (true) {
    Random draw = random;
    std::vector<Vector2f> points = ResampleRoute(PlanRoute(plan, space, length, draw));
    Smooth(space, &points);
    RouteWalk walk(points, options.speed);
    if (walk.duration() >= options.duration) return walk;
    length *= 1.3;
  }
}

}  // namespace

IndoorWalk::IndoorWalk(const FloorPlan& plan, const std::vector<Area>& taken,
                       const WalkOptions& options, const Random& random)
    : walk_(PlanWalk(plan, FreeSpace(plan, taken), options, random)) {}

}  // namespace orb360::town
