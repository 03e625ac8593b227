#include "apps/town/world/places.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace orb360::town {
namespace {

/// A street's stretch between two neighbouring junctions.
struct Stretch {
  size_t street = 0;
  double from = 0;
  double to = 0;
};

Stretch StretchBetween(const StreetPlan& plan, size_t a, size_t b) {
  for (const Junction::Arm& x : plan.junctions[a].arms) {
    for (const Junction::Arm& y : plan.junctions[b].arms) {
      if (x.street == y.street) return {x.street, x.station, y.station};
    }
  }
  return {};
}

bool IsAvenue(const Street& street) { return street.median > 0; }

void AddRoundabout(Random random, StreetPlan* plan) {
  std::vector<size_t> candidates;
  for (const size_t junction : plan->tour) {
    const auto& arms = plan->junctions[junction].arms;
    const bool has_avenue = std::any_of(arms.begin(), arms.end(), [&](const Junction::Arm& arm) {
      return IsAvenue(plan->streets[arm.street]);
    });
    if (!has_avenue) candidates.push_back(junction);
  }
  if (candidates.empty()) return;
  const size_t junction = random.Pick(std::span<const size_t>(candidates));
  const Vector2d centre = plan->junctions[junction].position;
  const Roundabout roundabout{junction, centre, random.Uniform(4.6, 5.6), 11.5};
  plan->roundabouts.push_back(roundabout);
  plan->islands.push_back({{centre}, 0, roundabout.island_radius});
}

/// Adds medians from shortly behind one junction to shortly before the next one.
void AddMedians(StreetPlan* plan) {
  constexpr double kClearance = 6;  // metres from other carriageways, for those who turn
  constexpr double kShortest = 6;
  constexpr double kSpacing = 2;  // metres between the points of a spine
  for (size_t index = 0; index < plan->streets.size(); ++index) {
    const Street& street = plan->streets[index];
    if (!IsAvenue(street)) continue;
    Island median{{}, 0, street.median};
    const auto finish = [&] {
      if (median.length > kShortest) plan->islands.push_back(median);
      median.spine.clear();
      median.length = 0;
    };
    const int points = static_cast<int>((street.Length() - 8) / kSpacing);
    for (int i = 0; i < points; ++i) {
      const double s = 4 + kSpacing * i;
      const Vector2d p = street.At(s).position;
      if (plan->DistanceToOtherRoads(p, index) < kClearance + street.median) {
        finish();
        continue;
      }
      if (!median.spine.empty()) median.length += (p - median.spine.back()).norm();
      median.spine.push_back(p);
    }
    finish();
  }
}

void AddPark(int columns, int rows, Random random, StreetPlan* plan) {
  // A block with a side that the tour uses.
  const auto node = [columns](int c, int r) { return static_cast<size_t>(r * columns + c); };
  std::vector<std::pair<int, int>> blocks;
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const auto on_tour = [&](size_t junction) {
        return std::find(plan->tour.begin(), plan->tour.end(), junction) != plan->tour.end() ? 1
                                                                                             : 0;
      };
      const int corners = on_tour(node(column, row)) + on_tour(node(column + 1, row)) +
                          on_tour(node(column, row + 1)) + on_tour(node(column + 1, row + 1));
      if (corners >= 2) blocks.emplace_back(column, row);
    }
  }
  if (blocks.empty()) return;
  const auto [column, row] = random.Pick(std::span<const std::pair<int, int>>(blocks));
  const std::vector<size_t> corners = {node(column, row), node(column + 1, row),
                                       node(column + 1, row + 1), node(column, row + 1)};
  Park park;
  park.centre.setZero();
  for (size_t i = 0; i < 4; ++i) {
    const Stretch side = StretchBetween(*plan, corners[i], corners[(i + 1) % 4]);
    const Street& street = plan->streets[side.street];
    const int pieces = static_cast<int>(std::abs(side.to - side.from) / 2);
    for (int k = 0; k < pieces; ++k) {
      const double station = std::lerp(side.from, side.to, static_cast<double>(k) / pieces);
      park.outline.push_back(street.At(station).position);
    }
    park.gates.push_back(street.At(0.5 * (side.from + side.to)).position);
    park.centre += 0.25 * park.gates.back();
  }
  plan->parks.push_back(std::move(park));
}

void AddBridge(Random random, StreetPlan* plan) {
  constexpr double kRamp = 6;  // metres from either side of the bridge to the next carriageway
  std::vector<Bridge> candidates;
  for (size_t i = 0; i < plan->tour.size(); ++i) {
    const Stretch stretch =
        StretchBetween(*plan, plan->tour[i], plan->tour[(i + 1) % plan->tour.size()]);
    const Street& street = plan->streets[stretch.street];
    if (IsAvenue(street)) continue;
    Bridge bridge;
    bridge.street = stretch.street;
    bridge.station = 0.5 * (stretch.from + stretch.to);
    const StreetPoint p = street.At(bridge.station);
    bridge.centre = p.position;
    bridge.along = p.tangent;
    bridge.half_opening = p.half_width + street.pavement + 0.3;
    const double room = plan->DistanceToOtherRoads(p.position, stretch.street) - kRamp;
    bridge.half_width = std::min(room, 5.5);
    if (bridge.half_width < 2.5) continue;
    // Extends as far to either side as the streets behind leave room.
    const Vector2d across(-p.tangent.y(), p.tangent.x());
    bridge.reach = bridge.half_opening;
    const auto is_free = [&](double reach) {
      for (const double side : {-1.0, 1.0}) {
        for (const double end : {-bridge.half_width, 0.0, bridge.half_width}) {
          const Vector2d q = bridge.centre + side * reach * across + end * bridge.along;
          if (plan->DistanceToOtherRoads(q, stretch.street) < 4.5) return false;
          for (const Park& park : plan->parks) {
            if (park.Contains(q)) return false;
          }
        }
      }
      return true;
    };
    constexpr double kFarthest = 24;
    while (bridge.reach < kFarthest && is_free(bridge.reach + 1)) bridge.reach += 1;
    if (bridge.reach > bridge.half_opening + 3) candidates.push_back(bridge);
  }
  if (!candidates.empty())
    plan->bridges.push_back(random.Pick(std::span<const Bridge>(candidates)));
}

}  // namespace

void AddPlaces(int columns, int rows, double spacing, const Random& random, StreetPlan* plan) {
  constexpr double kRoundaboutSpacing = 48;  // metres between streets that leave room for one
  constexpr double kParkSpacing = 40;
  if (spacing >= kRoundaboutSpacing && columns * rows >= 9) AddRoundabout(random.Fork(1), plan);
  AddMedians(plan);
  if (spacing >= kParkSpacing && columns * rows >= 9) AddPark(columns, rows, random.Fork(2), plan);
  AddBridge(random.Fork(3), plan);
}

}  // namespace orb360::town
