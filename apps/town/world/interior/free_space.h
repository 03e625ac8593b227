#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/world/interior/floor_plan.h"

namespace orb360::town {

/// The floor on which one can walk: rooms and doorways without walls, blocks and furniture.
class FreeSpace {
 public:
  FreeSpace(const FloorPlan& plan, const std::vector<Area>& taken);

  /// Returns the distance to the nearest obstacle, metres, 0 in one. Outside of rooms it means
  /// nothing.
  float Clearance(const Vector2f& p) const;

  using Cell = uint32_t;
  /// Returns the cells, a tenth of a metre wide, of the largest part of the floor that can be
  /// walked while keeping a distance from obstacles.
  const std::vector<Cell>& reachable() const { return reachable_; }
  Vector2f Middle(Cell cell) const;
  /// Returns a path between two reachable cells that prefers open ground.
  std::vector<Cell> Path(Cell from, Cell to) const;

  static constexpr float kMargin = 0.36F;  ///< from reachable cells to obstacles, metres

 private:
  std::vector<Cell> FindPart(Cell seed, std::vector<uint8_t>* seen) const;
  void MarkDistances(const FloorPlan& plan);

  std::vector<Area> obstacles_;
  Area bounds_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> distance_;  // by cell, at most kFarthest
  std::vector<Cell> reachable_;
};

}  // namespace orb360::town
