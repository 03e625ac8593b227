#pragma once

// Shaping AMX's tiles. Only for x86-64.

#include <algorithm>
#include <cstdint>

#include <immintrin.h>

#define ORB360_AMX                                            \
  __attribute__((                                             \
      target("avx512f,avx512bw,avx512vl,avx512dq,avx512bf16," \
             "amx-tile,amx-bf16")))

namespace orb360::nn {

// There are 8 tiles of 16 rows of 64 bytes. 0 to 3 hold sums: 16 pixels x 16 output channels, tile
// 2 a + b those of inputs 4 + a and weights 6 + b. An input tile is 16 pixels x up to 32 numbers,
// a weight tile as many, in pairs, x 16 output channels. A step loads four tiles in 8 cycles each,
// and multiplies four times in 16 cycles each: 2 x 2 is the smallest shape in which the
// multiplications hide the loads, and no larger one fits.
constexpr int kTileRows = 16;
constexpr int kTilePixels = 2 * kTileRows;

struct alignas(64) TileConfiguration {
  std::uint8_t palette = 1;
  std::uint8_t start_row = 0;
  std::uint8_t reserved[14] = {};
  std::uint16_t row_bytes[16] = {};
  std::uint8_t rows[16] = {};
};
static_assert(sizeof(TileConfiguration) == 64);

/// Shapes all tiles for `pixels` pixels of a row at once, up to kTilePixels, and for products of
/// `pairs` pairs of bfloat16, up to 16.
ORB360_AMX inline void ShapeTiles(int pixels, int pairs) {
  TileConfiguration tiles;
  for (int tile = 0; tile < 8; ++tile) {
    tiles.row_bytes[tile] = 64;
    tiles.rows[tile] = kTileRows;
  }
  for (const int a : {0, 1}) {
    const auto rows = static_cast<std::uint8_t>(std::clamp(pixels - a * kTileRows, 1, kTileRows));
    tiles.rows[4 + a] = tiles.rows[2 * a] = tiles.rows[2 * a + 1] = rows;
    tiles.row_bytes[4 + a] = static_cast<std::uint16_t>(4 * pairs);
    tiles.rows[6 + a] = static_cast<std::uint8_t>(pairs);
  }
  // GCC 12 believes that only the first 8 bytes are read.
  asm volatile("" : : "r"(&tiles) : "memory");
  _tile_loadconfig(&tiles);
}

}  // namespace orb360::nn
