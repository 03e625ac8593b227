#include "apps/town/image/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace orb360::town {
namespace {

uint32_t LatticeHash(int x, int y, uint32_t seed) {
  uint32_t h = seed * 0x9e3779b9U ^ static_cast<uint32_t>(x) * 0x85ebca6bU ^
               static_cast<uint32_t>(y) * 0xc2b2ae35U;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  return h ^ (h >> 15);
}

/// A random permutation that scrambles lattice coordinates with one look-up each (Perlin 2002),
/// because most of the painting time is spent in gradient noise.
class Permutation {
 public:
  static constexpr uint32_t kSize = 4096;  // 8 KiB: stays in the first-level cache
  Permutation() {
    for (uint32_t i = 0; i < kSize; ++i) values_[i] = static_cast<uint16_t>(i);
    for (uint32_t i = kSize - 1; i > 0; --i)
      std::swap(values_[i], values_[LatticeHash(static_cast<int>(i), 0, 1) % (i + 1)]);
  }
  uint32_t operator()(uint32_t x) const { return values_[x % kSize]; }

 private:
  std::array<uint16_t, kSize> values_;
};

const Permutation kPermutation;

int FloorToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

int Wrap(int x, int period) {
  if (x >= 0 && x < period) return x;
  const int remainder = x % period;
  return remainder < 0 ? remainder + period : remainder;
}

float Gradient(uint32_t hash, float dx, float dy) {
  static constexpr float kDirections[16][2] = {
      {1.0F, 0.0F},  {0.924F, 0.383F},   {0.707F, 0.707F},   {0.383F, 0.924F},
      {0.0F, 1.0F},  {-0.383F, 0.924F},  {-0.707F, 0.707F},  {-0.924F, 0.383F},
      {-1.0F, 0.0F}, {-0.924F, -0.383F}, {-0.707F, -0.707F}, {-0.383F, -0.924F},
      {0.0F, -1.0F}, {0.383F, -0.924F},  {0.707F, -0.707F},  {0.924F, -0.383F}};
  const float* direction = kDirections[hash & 15U];
  return direction[0] * dx + direction[1] * dy;
}

}  // namespace

float LatticeValue(int x, int y, uint32_t seed) {
  return static_cast<float>(LatticeHash(x, y, seed) >> 8) * 0x1p-24F;
}

float GradientNoise(float x, float y, int period, uint32_t seed) {
  const int cell_x = FloorToInt(x);
  const int cell_y = FloorToInt(y);
  const float fx = x - static_cast<float>(cell_x);
  const float fy = y - static_cast<float>(cell_y);
  const int x0 = Wrap(cell_x, period);
  const int y0 = Wrap(cell_y, period);
  const auto y1 = static_cast<uint32_t>(y0 + 1 == period ? 0 : y0 + 1);
  const uint32_t left = kPermutation(static_cast<uint32_t>(x0) + 977 * seed) + seed;
  const uint32_t right =
      kPermutation(static_cast<uint32_t>(x0 + 1 == period ? 0 : x0 + 1) + 977 * seed) + seed;
  const float wx = fx * fx * fx * (fx * (fx * 6 - 15) + 10);
  const float wy = fy * fy * fy * (fy * (fy * 6 - 15) + 10);
  const auto row = [&](uint32_t lattice_y, float dy) {
    const float a = Gradient(kPermutation(left + lattice_y), fx, dy);
    const float b = Gradient(kPermutation(right + lattice_y), fx - 1, dy);
    return a + wx * (b - a);
  };
  const float bottom = row(static_cast<uint32_t>(y0), fy);
  const float top = row(y1, fy - 1);
  return 1.5F * (bottom + wy * (top - bottom));  // the noise itself reaches about 0.7
}

float TiledFbm(float x, float y, int frequency, int octaves, uint32_t seed, float gain) {
  float sum = 0;
  float weight = 1;
  float total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    const auto scale = static_cast<float>(frequency);
    sum += weight *
           GradientNoise(x * scale, y * scale, frequency, seed + static_cast<uint32_t>(octave));
    total += weight * weight;
    weight *= gain;
    frequency *= 2;
  }
  return sum / std::sqrt(total);
}

float SpaceFbm(float x, float y, float z, int octaves, uint32_t seed, float gain) {
  constexpr int kPeriod = 64;
  const auto at = [&](float u, float v, uint32_t plane) {
    return TiledFbm(u / kPeriod, v / kPeriod, kPeriod, octaves, seed + 10 * plane, gain);
  };
  return 0.6F * (at(x, y, 0) + at(y, z, 1) + at(z, x, 2));
}

Cell TiledCells(float x, float y, int frequency, uint32_t seed) {
  x *= static_cast<float>(frequency);
  y *= static_cast<float>(frequency);
  const int cell_x = FloorToInt(x);
  const int cell_y = FloorToInt(y);
  Cell result{8, 8, 0};  // squared distances until the end
  for (int j = cell_y - 1; j <= cell_y + 1; ++j) {
    for (int i = cell_x - 1; i <= cell_x + 1; ++i) {
      const int wi = Wrap(i, frequency);
      const int wj = Wrap(j, frequency);
      const float dx = static_cast<float>(i) + LatticeValue(wi, wj, seed) - x;
      const float dy = static_cast<float>(j) + LatticeValue(wi, wj, seed ^ 0x5bd1e995U) - y;
      const float distance = dx * dx + dy * dy;
      if (distance < result.nearest) {
        result.second = result.nearest;
        result.nearest = distance;
        result.id = LatticeHash(wi, wj, seed + 77U);
      } else {
        result.second = std::min(result.second, distance);
      }
    }
  }
  result.nearest = std::sqrt(result.nearest);
  result.second = std::sqrt(result.second);
  return result;
}

}  // namespace orb360::town
