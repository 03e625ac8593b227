#pragma once

#include <cstdint>

#include "apps/town/image/texture.h"

/// Painters of the town's textures. Each tiles without a seam; the physical size of a tile is
/// stated in metres. Painters with a `variant` give a different texture for each value.
namespace orb360::town {

// --- ground ---
/// Worn asphalt with cracks, patches and tar seams; 8 m.
Texture PaintAsphalt(uint32_t seed);
/// Asphalt laid not long ago, without cracks; 4 m.
Texture PaintFreshAsphalt(uint32_t seed);
/// A cast-iron cover in its frame, the disc inscribed in the tile; 0.66 m.
Texture PaintManhole(uint32_t seed);
/// The grate of a drain; 0.5 m x 0.36 m.
Texture PaintDrain(uint32_t seed);
/// Concrete pavement slabs of 0.5 m; 4 m.
Texture PaintPavingSlabs(uint32_t seed);
/// Granite setts of 0.125 m in rows; 4 m.
Texture PaintSetts(uint32_t seed);
/// Plain concrete for kerbs and plinths; 4 m.
Texture PaintConcrete(uint32_t seed);
/// Lawn with dry and bare spots; 4 m.
Texture PaintGrass(uint32_t seed);
/// Worn white road paint; coverage is low where it has flaked off; 4 m.
Texture PaintRoadPaint(uint32_t seed);

// --- walls and roofs ---
/// Stretcher-bond brickwork, bricks of 0.25 m x 0.077 m with joints; 4 m.
Texture PaintBrick(uint32_t seed, const Rgba& brick, const Rgba& mortar);
/// Plaster with stains, hairline cracks and blotches, near white so that it can be tinted; 4 m.
Texture PaintPlaster(uint32_t seed);
/// Ashlar of 0.8 m x 0.4 m, near white; 4 m.
Texture PaintAshlar(uint32_t seed);
/// Pantiles in rows of 0.33 m; 4 m.
Texture PaintRoofTiles(uint32_t seed);
/// Slates in rows of 0.22 m, grey to violet; 4 m.
Texture PaintSlates(uint32_t seed);
/// Gravel of a flat roof; 4 m.
Texture PaintGravel(uint32_t seed);

// --- openings: the unit tile is the whole image ---
/// A room behind a window pane: curtains, blinds, lamps or darkness.
Texture PaintRoom(uint32_t seed);
/// A shop window's display: shelves with goods under a bright ceiling.
Texture PaintShop(uint32_t seed);
/// A panelled or glazed door.
Texture PaintDoor(uint32_t seed);
/// A louvred shutter, near white so that it can be tinted.
Texture PaintLouvres(uint32_t seed);
/// A closed shop's roller shutter with graffiti.
Texture PaintRollerShutter(uint32_t seed);
/// Vertical-bar railing, a cut-out; 1 m x 1 m.
Texture PaintRailing(uint32_t seed);

// --- signs: the unit tile is the whole image ---
/// A fascia board with a name on it; 4:1.
Texture PaintSign(uint32_t seed);
/// A car's number plate; 4:1.
Texture PaintNumberPlate(uint32_t seed);
/// A bill with an image, a headline and small print; 1:2.
Texture PaintPoster(uint32_t seed);
/// An enamel plate with one or two digits; square.
Texture PaintHouseNumber(uint32_t seed);
/// A faded advertisement painted on a wall, a cut-out where it has flaked off; square.
Texture PaintMural(uint32_t seed);

// --- plants ---
/// A spray of leaves on a twig, a cut-out.
Texture PaintLeaves(uint32_t seed);
/// Bark; 1 m.
Texture PaintBark(uint32_t seed);

// --- everything else ---
/// Large blotches in four independent channels, mean 0.5: multiplied over other textures at
/// another scale to hide their repetition.
Texture PaintBlotches(uint32_t seed);
/// Plain white with faint noise, to be tinted.
Texture PaintPlain(uint32_t seed);

}  // namespace orb360::town
