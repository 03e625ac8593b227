#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "apps/town/render/ray_scene.h"

namespace orb360::town {

/// What a person who carries the camera needs. Metres.
struct WalkerSize {
  double camera_height = 1.6;  ///< above the floor
  double head_room = 0.3;      ///< above the camera
  double clearance = 0.3;      ///< from walls and from edges of the floor, where there is room
  double step = 0.35;          ///< the highest step
};

/// A place to stand, above the middle of a cell of the grid.
struct Standing {
  int column = 0;
  int row = 0;
  float floor = 0;      ///< height of the floor, metres
  float clearance = 0;  ///< horizontal distance from what is not free, at most kFarClearance
  /// The places that one step leads to, in the order of kWalkDirections; kNoPlace for none.
  std::array<uint32_t, 8> next{};
};

inline constexpr uint32_t kNoPlace = std::numeric_limits<uint32_t>::max();
inline constexpr float kFarClearance = 1;  ///< metres
/// Columns and rows to the eight neighbours, counter-clockwise from +x. The opposite of k is k ^ 4.
inline constexpr std::array<std::array<int, 2>, 8> kWalkDirections = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// The places where a person can stand in a scene, several above each other where there are floors,
/// and the steps between them.
class WalkableGrid {
 public:
  static constexpr float kCell = 0.2F;  ///< metres

  /// Examines the floors in a box. A floor is a surface that is at most 45 degrees steep; a face
  /// counts from both sides. `is_floor` says by material whether people stand on it; empty: on all.
  /// Throws UserError if the box has more than 25 million cells.
  WalkableGrid(const RayScene& scene, const Eigen::AlignedBox3f& box,
               const std::vector<bool>& is_floor, const WalkerSize& size);

  const std::vector<Standing>& places() const { return places_; }
  /// Returns the place on the floor (world, z up).
  Vector3f PositionOf(uint32_t place) const;
  /// Returns the place in the cell of a point whose floor is nearest to its height, within
  /// `tolerance` metres; kNoPlace if there is none.
  uint32_t Find(const Vector3f& point, float tolerance) const;
  /// Returns the connected component of each place, numbered from 0.
  std::vector<uint32_t> Components() const;

 private:
  void FindFloors(const FrameScene& scene, const std::vector<bool>& is_floor,
                  const WalkerSize& size);
  void Connect(const RayScene& scene, const WalkerSize& size);
  void SpreadClearance();

  Eigen::AlignedBox3f box_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Standing> places_;    // by row, column and falling height
  std::vector<uint32_t> first_in_;  // by row and column, and the end
};

}  // namespace orb360::town
