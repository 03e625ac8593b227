#pragma once

#include <cstdint>

#include "apps/town/image/texture.h"

/// Painters of the surfaces of rooms and of what stands in them. Each tiles without a seam unless
/// the unit tile is said to be the whole image; the physical size of a tile is stated in metres.
namespace orb360::town {

// --- walls and ceilings ---
/// Painted wall, near white so that it can be tinted: marks of the roller, faint stains, and in
/// rooms that are `worn` (0 to 1) scuffs and patches; 3 m.
Texture PaintWallPaint(uint32_t seed, float worn);
/// Wallpaper: stripes, a repeated ornament or scattered flowers on a ground; 1.5 m.
Texture PaintWallpaper(uint32_t seed, const Rgba& ground, const Rgba& figure);
/// Panels of 0.6 m of mineral fibre with holes, in a frame; 2.4 m.
Texture PaintCeilingPanels(uint32_t seed);

// --- floors ---
/// Rows of planks or of short staves, `rows` across a tile; 2 m.
Texture PaintPlanks(uint32_t seed, int rows, const Rgba& wood);
/// Herringbone parquet; 1.6 m.
Texture PaintHerringbone(uint32_t seed, const Rgba& wood);
/// Glazed tiles, `columns` x `rows` to a tile of the texture, with grout; 2 m. Some of them have
/// the colour `other`: every second one, like a chess-board, if `chequered`.
Texture PaintTiles(uint32_t seed, int columns, int rows, const Rgba& tile, const Rgba& other,
                   bool chequered);
/// Linoleum or terrazzo: specks of a few colours, rubbed by walking; 2 m.
Texture PaintTerrazzo(uint32_t seed, const Rgba& ground);
/// Carpet with pile, worn and stained, or with a pattern of lines; 2 m.
Texture PaintCarpet(uint32_t seed, const Rgba& pile);
/// Screed of garages and halls with cracks, tyre marks and oil; 6 m.
Texture PaintScreed(uint32_t seed);

// --- furniture and goods ---
/// Wood with grain along v, near white so that it can be tinted; 1 m.
Texture PaintVeneer(uint32_t seed);
/// Woven cloth, plain, striped, chequered or flowered; 0.8 m.
Texture PaintCloth(uint32_t seed, const Rgba& ground, const Rgba& figure);
/// Spines of books side by side; the unit tile is the whole image, about 0.9 m x 0.28 m.
Texture PaintBooks(uint32_t seed);
/// A side of a cardboard box with tape, a label and print; the unit tile is the whole image.
Texture PaintCarton(uint32_t seed);
/// A painting, a photograph or a print in its mount; the unit tile is the whole image.
Texture PaintPicture(uint32_t seed);
/// The screen of a computer with windows of text; the unit tile is the whole image.
Texture PaintScreen(uint32_t seed);

}  // namespace orb360::town
