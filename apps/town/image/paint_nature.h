#pragma once

#include <cstdint>

#include "apps/town/image/texture.h"

/// Painters of what grows and lies in woods and on hills. Each tiles without a seam unless it is a
/// cut-out, whose unit tile is the whole image; the physical size of a tile is stated in metres.
namespace orb360::town {

// --- ground ---
/// Fallen leaves, twigs, needles and moss on earth; 4 m. `leaves` (0 to 1) is how much of the
/// ground is covered by leaves, `moss` by moss.
Texture PaintForestFloor(uint32_t seed, float leaves, float moss);
/// Trodden earth with pebbles and roots; 4 m.
Texture PaintTrail(uint32_t seed);
/// Heather, dry grass and bare spots; 4 m.
Texture PaintHeath(uint32_t seed);
/// Weathered rock with layers, cracks and lichen, near white so that it can be tinted; 4 m.
Texture PaintRock(uint32_t seed);

// --- plants: cut-outs ---
/// A spruce's or a pine's branch with its twigs, from the trunk (below) to its tip (above).
Texture PaintNeedleBranch(uint32_t seed);
/// A fern's frond, from its stalk (below) to its tip (above).
Texture PaintFern(uint32_t seed);
/// Blades of grass that fan out from below; green, or dry where `dry` is 1.
Texture PaintGrassTuft(uint32_t seed, float dry);

}  // namespace orb360::town
