#pragma once

#include <cstdint>

namespace orb360::town {

/// Returns gradient noise in about [-1, 1] on a lattice of spacing 1. It is periodic with `period`
/// cells in x and y: sampled over [0, period)² it tiles without a seam.
float GradientNoise(float x, float y, int period, uint32_t seed);

/// Sum of `octaves` of GradientNoise over the unit tile (x, y in [0, 1)), the first with
/// `frequency` cells across the tile; each next octave doubles the frequency and is weighted by
/// `gain`. In about [-1, 1].
float TiledFbm(float x, float y, int frequency, int octaves, uint32_t seed, float gain = 0.5F);

/// Sum of `octaves` of noise over space in about [-1, 1], the first with features of unit size: the
/// mean of TiledFbm over the three coordinate planes. Periodic with 64 along each axis.
float SpaceFbm(float x, float y, float z, int octaves, uint32_t seed, float gain = 0.5F);

/// The result of TiledCells: the distances, in cells, to the nearest and the second nearest of the
/// points scattered one per cell, and a hash of the nearest.
struct Cell {
  float nearest;
  float second;
  uint32_t id;
};

/// Cellular noise (Worley 1996) over the unit tile with `frequency` cells across it.
Cell TiledCells(float x, float y, int frequency, uint32_t seed);

/// Hash of a lattice point, uniform in [0, 1).
float LatticeValue(int x, int y, uint32_t seed);

/// 0 below `low`, 1 above `high`, a cubic in between.
inline float SmoothStep(float low, float high, float x) {
  const float t = (x - low) / (high - low);
  if (t <= 0) return 0;
  if (t >= 1) return 1;
  return t * t * (3 - 2 * t);
}

}  // namespace orb360::town
