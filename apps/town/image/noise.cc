#include "apps/town/image/noise.h"

#include <algorithm>
#include <cmath>

namespace orb360::town {
namespace {

uint32_t LatticeHash(int x, int y, uint32_t seed) {
  uint32_t h = seed * 0x9e3779b9U ^ static_cast<uint32_t>(x) * 0x85ebca6bU ^
               static_cast<uint32_t>(y) * 0xc2b2ae35U;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  return h ^ (h >> 15);
}

int Wrap(int x, int period) {
  const int remainder = x % period;
  return remainder < 0 ? remainder + period : remainder;
}

float Gradient(int x, int y, uint32_t seed, float dx, float dy) {
  static constexpr float kDirections[16][2] = {
      {1.0F, 0.0F},  {0.924F, 0.383F},   {0.707F, 0.707F},   {0.383F, 0.924F},
      {0.0F, 1.0F},  {-0.383F, 0.924F},  {-0.707F, 0.707F},  {-0.924F, 0.383F},
      {-1.0F, 0.0F}, {-0.924F, -0.383F}, {-0.707F, -0.707F}, {-0.383F, -0.924F},
      {0.0F, -1.0F}, {0.383F, -0.924F},  {0.707F, -0.707F},  {0.924F, -0.383F}};
  const float* direction = kDirections[LatticeHash(x, y, seed) & 15U];
  return direction[0] * dx + direction[1] * dy;
}

}  // namespace

float LatticeValue(int x, int y, uint32_t seed) {
  return static_cast<float>(LatticeHash(x, y, seed) >> 8) * 0x1p-24F;
}

float GradientNoise(float x, float y, int period, uint32_t seed) {
  const float floor_x = std::floor(x);
  const float floor_y = std::floor(y);
  const float fx = x - floor_x;
  const float fy = y - floor_y;
  const int x0 = Wrap(static_cast<int>(floor_x), period);
  const int y0 = Wrap(static_cast<int>(floor_y), period);
  const int x1 = x0 + 1 == period ? 0 : x0 + 1;
  const int y1 = y0 + 1 == period ? 0 : y0 + 1;
  const float wx = fx * fx * fx * (fx * (fx * 6 - 15) + 10);
  const float wy = fy * fy * fy * (fy * (fy * 6 - 15) + 10);
  const float bottom =
      std::lerp(Gradient(x0, y0, seed, fx, fy), Gradient(x1, y0, seed, fx - 1, fy), wx);
  const float top =
      std::lerp(Gradient(x0, y1, seed, fx, fy - 1), Gradient(x1, y1, seed, fx - 1, fy - 1), wx);
  return 1.5F * std::lerp(bottom, top, wy);  // the noise itself reaches about 0.7
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

Cell TiledCells(float x, float y, int frequency, uint32_t seed) {
  x *= static_cast<float>(frequency);
  y *= static_cast<float>(frequency);
  const int cell_x = static_cast<int>(std::floor(x));
  const int cell_y = static_cast<int>(std::floor(y));
  Cell result{8, 8, 0};
  for (int j = cell_y - 1; j <= cell_y + 1; ++j) {
    for (int i = cell_x - 1; i <= cell_x + 1; ++i) {
      const int wi = Wrap(i, frequency);
      const int wj = Wrap(j, frequency);
      const float dx = static_cast<float>(i) + LatticeValue(wi, wj, seed) - x;
      const float dy = static_cast<float>(j) + LatticeValue(wi, wj, seed ^ 0x5bd1e995U) - y;
      const float distance = std::sqrt(dx * dx + dy * dy);
      if (distance < result.nearest) {
        result.second = result.nearest;
        result.nearest = distance;
        result.id = LatticeHash(wi, wj, seed + 77U);
      } else {
        result.second = std::min(result.second, distance);
      }
    }
  }
  return result;
}

}  // namespace orb360::town
