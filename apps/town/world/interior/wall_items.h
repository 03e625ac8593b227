#pragma once

#include "apps/town/world/interior/kit.h"

/// Things on walls and ceilings, on the panel of their wall.
namespace orb360::town {

/// A framed picture or a bare poster with its lower left corner at (x, z).
void AddPicture(Kit& kit, const Panel& p, float x, float z, float width, float height);
/// A whiteboard, a blackboard or a notice board with papers.
void AddBoard(Kit& kit, const Panel& p, float x, float z, float width, float height);
/// A radiator with ribs and its pipes.
void AddRadiator(Kit& kit, const Panel& p, float x, float width, float height);
/// A curtain in folds that hangs from `top` to `bottom`.
void AddCurtain(Kit& kit, const Panel& p, float x0, float x1, float bottom, float top);
/// A light switch or a socket.
void AddSocket(Kit& kit, const Panel& p, float x, float z);
/// Where pipes may run: metres above the floor.
struct PipeSpace {
  float low, high;
  bool
      has_corner;  ///< the corner at the panel's origin is free, so that branches may go down there
};
/// What branches of pipes take of the corner: along the wall and away from it, metres.
inline constexpr float kBranchWidth = 0.42F;
inline constexpr float kBranchDepth = 0.3F;
/// Pipes, ducts and cables along a wall below the ceiling. Returns whether any goes to the floor.
bool AddPipes(Kit& kit, const Panel& p, float length, const PipeSpace& space);
/// A sheet of cloth or of a carpet on the floor; the panel's origin is its corner.
void AddRug(Kit& kit, const Panel& p, float width, float depth);

}  // namespace orb360::town
