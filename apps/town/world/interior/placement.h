#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "apps/town/world/interior/floor_plan.h"
#include "apps/town/world/interior/kit.h"

namespace orb360::town {

/// Finds free places for furniture in one room and remembers them. Doorways, the ground before
/// them, blocks and what stands already stay free.
class Placement {
 public:
  using Build = std::function<void(const Panel&)>;
  /// What stands before a wall: from `left` to `right` on its panel and up to `height`, metres.
  struct Span {
    float left, right, height;
  };

  /// Keeps references to its arguments. Areas that are taken are appended to `taken`.
  Placement(Kit& kit, const FloorPlan& plan, const Room& room, std::vector<Area>* taken);

  Kit& kit() const { return kit_; }
  const Room& room() const { return room_; }
  bool Chance(double p) { return kit_.random.Chance(p); }
  float Draw(double low, double high) { return kit_.Draw(low, high); }

  bool IsFree(const Area& area) const;
  void Take(const Area& area) { taken_->push_back(area); }
  const std::vector<Span>& Standing(Side side) const { return walls_[static_cast<size_t>(side)]; }

  /// Returns the floor that something on a panel covers.
  static Area AreaOf(const Panel& p, float width, float depth);
  /// Places something against a wall; tall things keep clear of windows. Returns its panel.
  std::optional<Panel> AtWall(float width, float depth, float height, const Build& build,
                              float gap = 0.01F);
  /// Places something with its middle anywhere in the room, in steps of `turn` radians (0: any).
  bool Free(float width, float depth, float keep, const Build& build, float turn = kQuarterTurn);

 private:
  static constexpr float kQuarterTurn = 1.57079633F;  // radians

  Kit& kit_;
  const Room& room_;
  std::vector<Area>* taken_;
  std::vector<Area> doors_;
  std::array<std::vector<Span>, 4> walls_;
};

}  // namespace orb360::town
