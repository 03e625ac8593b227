#include "apps/town/import/walk_route.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace orb360::town {
namespace {

/// How far goals are, as the cost of the way there (metres where there is room).
constexpr float kNearestGoal = 8;
constexpr float kFarthestGoal = 60;
constexpr int kCandidates = 24;
/// Direction is measured over so many places.
constexpr size_t kHeadingPlaces = 8;
/// Visits are counted in squares of so many cells.
constexpr int kSquare = 10;

/// Returns the cost of a metre: 1 where there is room, and more towards what is near.
float CostOfMetre(float place_clearance, double clearance) {
  const auto wanted = static_cast<float>(clearance);
  if (place_clearance < wanted) return 20;
  const float lack = std::max(0.0F, 2 * wanted - place_clearance) / wanted;
  return 1 + 2 * lack;
}

/// The cheapest ways from one place to all places up to a cost (Dijkstra 1959).
class Ways {
 public:
  Ways(const WalkableGrid& grid, uint32_t start, double clearance) : start_(start) {
    using Entry = std::pair<float, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    steps_[start] = {0, start};
    open.emplace(0.0F, start);
    while (!open.empty()) {
      const auto [cost, i] = open.top();
      open.pop();
      if (cost > steps_[i].cost || cost > kFarthestGoal) continue;
      reached_.push_back(i);
      for (const uint32_t there : grid.places()[i].next) {
        if (there == kNoPlace) continue;
        const float way = (grid.PositionOf(there) - grid.PositionOf(i)).norm();
        const float next = cost + way * CostOfMetre(grid.places()[there].clearance, clearance);
        const auto [entry, is_new] = steps_.try_emplace(there, Step{next, i});
        if (!is_new && entry->second.cost <= next) continue;
        entry->second = {next, i};
        open.emplace(next, there);
      }
    }
  }

  /// Places in the order of their cost.
  const std::vector<uint32_t>& reached() const { return reached_; }
  float CostOf(uint32_t place) const { return steps_.at(place).cost; }
  /// Returns the places on the way to a reached place, without the start.
  std::vector<uint32_t> To(uint32_t place) const {
    std::vector<uint32_t> way;
    for (; place != start_; place = steps_.at(place).from) way.push_back(place);
    std::reverse(way.begin(), way.end());
    return way;
  }

 private:
  struct Step {
    float cost;
    uint32_t from;
  };
  uint32_t start_;
  std::unordered_map<uint32_t, Step> steps_;
  std::vector<uint32_t> reached_;
};

Vector2f Heading(const WalkableGrid& grid, uint32_t from, uint32_t to) {
  return (grid.PositionOf(to) - grid.PositionOf(from)).head<2>().stableNormalized();
}

}  // namespace

std::vector<uint32_t> FindRoute(const WalkableGrid& grid, uint32_t start, double clearance,
                                double length, Random* random) {
  std::vector<uint32_t> route = {start};
  std::unordered_map<uint64_t, int> visits;
  const auto square_of = [&](uint32_t place) {
    const Standing& p = grid.places()[place];
    return static_cast<uint64_t>(p.row / kSquare) << 32 | static_cast<uint64_t>(p.column / kSquare);
  };
  double travelled = 0;
  while (travelled < length) {
    const Ways ways(grid, route.back(), clearance);
    const std::vector<uint32_t>& reached = ways.reached();
    if (reached.size() < 2) return {};
    // In a small area the farthest part of it.
    const float least = std::min(kNearestGoal, 0.5F * ways.CostOf(reached.back()));
    const auto first = std::partition_point(
        reached.begin(), reached.end(), [&](uint32_t place) { return ways.CostOf(place) < least; });
    const auto count = static_cast<int>(reached.end() - first);
    const size_t back = std::min(kHeadingPlaces, route.size() - 1);
    const Vector2f heading = Heading(grid, route[route.size() - 1 - back], route.back());
    std::vector<uint32_t> best;
    double best_score = -1e9;
    for (int i = 0; i < kCandidates; ++i) {
      const uint32_t goal = *(first + random->Int(count));
      std::vector<uint32_t> way = ways.To(goal);
      if (way.empty()) continue;
      const Vector2f begins =
          Heading(grid, route.back(), way[std::min(kHeadingPlaces, way.size()) - 1]);
      // A way back counts as much as eight visits: it makes the camera turn on the spot.
      double score = 4 * heading.dot(begins) - visits[square_of(goal)];
      constexpr double kTooNear = 1e6;  // to a wall, unless all goals are
      if (grid.places()[goal].clearance < static_cast<float>(clearance)) score -= kTooNear;
      if (score <= best_score) continue;
      best_score = score;
      best = std::move(way);
    }
    if (best.empty()) return {};
    for (const uint32_t place : best) {
      travelled += (grid.PositionOf(place) - grid.PositionOf(route.back())).head<2>().norm();
      if (square_of(place) != square_of(route.back())) ++visits[square_of(place)];
      route.push_back(place);
    }
  }
  return route;
}

}  // namespace orb360::town
