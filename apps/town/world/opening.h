#pragma once

#include "apps/town/world/facade.h"

namespace orb360::town {

/// An opening in a wall, metres on the wall's panel.
struct Opening {
  float x0, x1, z0, z1;
};

/// A piece of wall, metres on its panel.
struct WallPiece {
  float left, right, bottom, top;
};

/// Adds a rectangle of wall whose tint is multiplied by `low` at its bottom and `high` at its top,
/// for splashed dirt and for rain.
void AddWeatheredRectangle(MeshBuilder& b, MaterialId wall, const Panel& p, const WallPiece& piece,
                           float low, float high);

/// Adds the wall around an opening and the opening's four reveals, with the stain below its sill.
/// `base` is the factor on the tint at the piece's foot.
void AddWallWithOpening(MeshBuilder& b, MaterialId wall, const Rgba& tint, const Panel& p,
                        const WallPiece& piece, const Opening& opening, float reveal,
                        float base = 1);

/// Adds a pane `depth` behind the panel which, like real panes, is slightly out of line with its
/// neighbours.
void AddPane(MeshBuilder& b, MaterialId pane, const Panel& p, const Opening& opening, float depth,
             Random& random);

/// Adds a frame with a mullion and a transom (if `divided`) in front of a pane of `room`, `reveal`
/// behind the panel.
void AddWindow(MeshBuilder& b, const Rgba& frame, const Panel& p, const Opening& opening,
               float reveal, bool divided, MaterialId room, Random& random);

/// Adds a sill and, in styles that have them, jambs and a lintel.
void AddSurround(MeshBuilder& b, const FacadeStyle& style, const Panel& p, const Opening& opening);

/// Adds a balcony of the style's kind, with the top of its slab at `z`.
void AddBalcony(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float x0, float x1,
                float z, Random& random);

/// Adds a box of flowers or ivy that hangs from a sill.
void AddFlowerBox(MeshBuilder& b, const Panel& p, const Opening& opening, Random& random);

/// Adds steps in front of a door at height `z`, down to `drop` below the panel's origin.
void AddSteps(MeshBuilder& b, const Panel& p, float x0, float x1, float z, float drop);

}  // namespace orb360::town
