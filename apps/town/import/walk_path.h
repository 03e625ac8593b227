#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "apps/town/import/walkable_grid.h"

namespace orb360::town {

/// What a walk shall be like.
struct WalkOptions {
  WalkerSize size = {};
  uint64_t seed = 0;
  double length = 100;                ///< metres along the floor plan
  std::vector<Vector3f> starts = {};  ///< on or above the floor, z up, metres; none: anywhere
  std::vector<bool> is_floor = {};    ///< by material; see WalkableGrid
};

/// The positions of a camera in even distances along a walk.
struct Walk {
  std::vector<Eigen::Vector3d> positions;  ///< z up, metres
  double spacing = 0;                      ///< metres along the floor plan
};

/// Walks through a scene: from one of the starts that lead into the largest connected area (without
/// starts: from anywhere in the largest area) to goals drawn from the seed, one after the other, on
/// ways that are short and keep clear of walls and edges. The way is smoothed where that keeps the
/// clearance, and the height over steps. The same input gives the same walk. Throws UserError
/// (without the name of the file) if nobody can stand or walk in the scene.
Walk WalkThrough(const RayScene& scene, const Eigen::AlignedBox3f& box, const WalkOptions& options);

}  // namespace orb360::town
