#include "apps/town/world/interior/free_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace orb360::town {
namespace {

constexpr float kCell = 0.1F;      // metres
constexpr float kFarthest = 1.0F;  // metres; more does not matter
constexpr float kWall = 0.1F;      // metres behind a wall's face that count as its body

/// Returns the walls of a room between its doors.
std::vector<Area> WallsOf(const Room& room) {
  std::vector<Area> walls;
  for (const Side side : {Side::kSouth, Side::kEast, Side::kNorth, Side::kWest}) {
    const bool is_x = side == Side::kSouth || side == Side::kNorth;
    const Area& a = room.area;
    const auto add = [&](float begin, float end) {
      if (side == Side::kSouth) walls.push_back({begin, end, a.y0 - kWall, a.y0});
      if (side == Side::kNorth) walls.push_back({begin, end, a.y1, a.y1 + kWall});
      if (side == Side::kWest) walls.push_back({a.x0 - kWall, a.x0, begin, end});
      if (side == Side::kEast) walls.push_back({a.x1, a.x1 + kWall, begin, end});
    };
    float begin = is_x ? a.x0 : a.y0;
    for (const WallHole& hole : room.holes[static_cast<size_t>(side)]) {
      if (hole.is_window) continue;
      add(begin, hole.begin);
      begin = hole.end;
    }
    add(begin, is_x ? a.x1 : a.y1);
  }
  return walls;
}

constexpr std::array<std::array<int, 2>, 8> kSteps = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

}  // namespace

FreeSpace::FreeSpace(const FloorPlan& plan, const std::vector<Area>& taken) : obstacles_(taken) {
  bounds_ = plan.rooms[0].area;
  for (const Room& room : plan.rooms) {
    const Area& a = room.area;
    bounds_ = {std::min(bounds_.x0, a.x0), std::max(bounds_.x1, a.x1), std::min(bounds_.y0, a.y0),
               std::max(bounds_.y1, a.y1)};
    for (const Area& wall : WallsOf(room)) obstacles_.push_back(wall);
    obstacles_.insert(obstacles_.end(), room.blocks.begin(), room.blocks.end());
  }
  MarkDistances(plan);
  std::vector<uint8_t> seen(distance_.size());
  for (Cell cell = 0; cell < distance_.size(); ++cell) {
    if (seen[cell] != 0 || distance_[cell] < kMargin) continue;
    std::vector<Cell> part = FindPart(cell, &seen);
    if (part.size() > reachable_.size()) reachable_ = std::move(part);
  }
}

void FreeSpace::MarkDistances(const FloorPlan& plan) {
  columns_ = static_cast<int>(bounds_.width() / kCell) + 1;
  rows_ = static_cast<int>(bounds_.depth() / kCell) + 1;
  distance_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0);
  const auto for_cells = [&](const Area& area, const auto& change) {
    const auto index = [](float x, int count) {
      return std::clamp(static_cast<int>(x / kCell), 0, count - 1);
    };
    for (int j = index(area.y0 - bounds_.y0, rows_); j <= index(area.y1 - bounds_.y0, rows_); ++j) {
      for (int i = index(area.x0 - bounds_.x0, columns_);
           i <= index(area.x1 - bounds_.x0, columns_); ++i) {
        const Cell cell = static_cast<Cell>(j) * static_cast<Cell>(columns_) + static_cast<Cell>(i);
        change(Middle(cell), &distance_[cell]);
      }
    }
  };
  const auto open = [&](const Area& floor) {
    for_cells(floor, [&](const Vector2f& p, float* distance) {
      if (floor.Contains(p)) *distance = kFarthest;
    });
  };
  for (const Room& room : plan.rooms) open(room.area);
  for (const Doorway& way : plan.doorways) open(way.Floor());
  for (const Area& obstacle : obstacles_) {
    for_cells(obstacle.Grown(kFarthest), [&](const Vector2f& p, float* distance) {
      *distance = std::min(*distance, obstacle.Distance(p));
    });
  }
}

float FreeSpace::Clearance(const Vector2f& p) const {
  float least = std::numeric_limits<float>::max();
  for (const Area& obstacle : obstacles_) least = std::min(least, obstacle.Distance(p));
  return least;
}

Vector2f FreeSpace::Middle(Cell cell) const {
  const auto columns = static_cast<Cell>(columns_);
  return {bounds_.x0 + kCell * (static_cast<float>(cell % columns) + 0.5F),
          bounds_.y0 + kCell * (static_cast<float>(cell / columns) + 0.5F)};
}

std::vector<FreeSpace::Cell> FreeSpace::FindPart(Cell seed, std::vector<uint8_t>* seen) const {
  std::vector<Cell> part = {seed};
  (*seen)[seed] = 1;
  for (size_t next = 0; next < part.size(); ++next) {
    const int i = static_cast<int>(part[next]) % columns_;
    const int j = static_cast<int>(part[next]) / columns_;
    for (const auto& [di, dj] : kSteps) {
      if (i + di < 0 || i + di >= columns_ || j + dj < 0 || j + dj >= rows_) continue;
      const auto cell = static_cast<Cell>((j + dj) * columns_ + i + di);
      if ((*seen)[cell] != 0 || distance_[cell] < kMargin) continue;
      (*seen)[cell] = 1;
      part.push_back(cell);
    }
  }
  return part;
}

std::vector<FreeSpace::Cell> FreeSpace::Path(Cell from, Cell to) const {
  constexpr float kInfinity = std::numeric_limits<float>::max();
  std::vector<float> cost(distance_.size(), kInfinity);
  std::vector<Cell> before(distance_.size(), from);
  using Entry = std::pair<float, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const Vector2f goal = Middle(to);
  const auto rest = [&](Cell cell) { return (goal - Middle(cell)).norm(); };
  cost[from] = 0;
  queue.emplace(rest(from), from);
  while (!queue.empty()) {
    const Cell here = queue.top().second;
    const float estimate = queue.top().first;
    queue.pop();
    if (here == to) break;
    if (estimate > cost[here] + rest(here) + 1e-3F) continue;
    const int i = static_cast<int>(here) % columns_;
    const int j = static_cast<int>(here) / columns_;
    for (const auto& [di, dj] : kSteps) {
      if (i + di < 0 || i + di >= columns_ || j + dj < 0 || j + dj >= rows_) continue;
      const auto cell = static_cast<Cell>((j + dj) * columns_ + i + di);
      if (distance_[cell] < kMargin) continue;
      const float step = kCell * (di != 0 && dj != 0 ? std::numbers::sqrt2_v<float> : 1.0F);
      const float narrow = 2 * std::max(0.0F, 0.8F - distance_[cell]);
      const float total = cost[here] + step * (1 + narrow);
      if (total >= cost[cell]) continue;
      cost[cell] = total;
      before[cell] = here;
      queue.emplace(total + rest(cell), cell);
    }
  }
  std::vector<Cell> path;
  for (Cell cell = to; cell != from; cell = before[cell]) path.push_back(cell);
  path.push_back(from);
  std::ranges::reverse(path);
  return path;
}

}  // namespace orb360::town
