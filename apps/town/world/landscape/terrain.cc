#include "apps/town/world/landscape/terrain.h"

#include <vector>

#include "apps/town/image/noise.h"

namespace orb360::town {
namespace {

constexpr float kPeriod = 512;  // metres, in which the noise repeats
constexpr float kSunk = 4;      // metres by which the far ground lies below the near one

/// Noise of about unit size whose largest features are `size` metres.
float Fbm(const Vector2f& p, float size, int octaves, uint32_t seed, float gain = 0.5F) {
  return TiledFbm(p.x() / kPeriod, p.y() / kPeriod, static_cast<int>(kPeriod / size), octaves, seed,
                  gain);
}

}  // namespace

float Terrain::Height(const Vector2f& p) const { return Height(p, trail_->Distance(p)); }

float Terrain::Height(const Vector2f& p, float from_trail) const {
  const TerrainOptions& o = options_;
  float height = 2 * o.hills * Fbm(p, o.hill_size, 3, o.seed, 0.4F);
  const float r = p.norm();
  height += o.mountains * SmoothStep(60, 260, r) * (0.5F + Fbm(p, 128, 3, o.seed + 10));
  // Feet and wheels have worn the trail smooth and a little lower.
  const float wild = SmoothStep(Trail::kHalfWidth, 4 * Trail::kHalfWidth, from_trail);
  height += o.bumps * (0.1F + 1.9F * wild) * Fbm(p, 3, 4, o.seed + 20);
  return height - 0.06F * (1 - SmoothStep(0.4F, 1.0F, from_trail));
}

template <typename Holds>
void Terrain::AddGrid(float half, float cell, float sunk_within, const GroundMaterials& materials,
                      MeshBuilder& b, Holds holds) const {
  const int side = static_cast<int>(2 * half / cell) + 1;
  const auto size = static_cast<size_t>(side);
  const auto place = [&](size_t i) -> Vector2f {
    return cell * Vector2f(static_cast<float>(i % size), static_cast<float>(i / size)) -
           Vector2f(half, half);
  };
  std::vector<float> from_trail(size * size);
  std::vector<float> heights(size * size);
#pragma omp parallel for
  for (int row = 0; row < side; ++row) {
    for (size_t i = static_cast<size_t>(row) * size; i < static_cast<size_t>(row + 1) * size; ++i) {
      from_trail[i] = trail_->Distance(place(i));
      heights[i] = Height(place(i), from_trail[i]);
      if (place(i).cwiseAbs().maxCoeff() < sunk_within) heights[i] -= kSunk;
    }
  }
  const float scale = b.materials().all[materials.trail].tiles_per_metre;
  std::vector<uint32_t> index(size * size);
  const auto slope = [&](size_t i) -> Vector2f {
    const size_t x = i % size;
    const size_t y = i / size;
    const size_t left = x > 0 ? i - 1 : i;
    const size_t right = x + 1 < size ? i + 1 : i;
    const size_t low = y > 0 ? i - size : i;
    const size_t high = y + 1 < size ? i + size : i;
    return {(heights[right] - heights[left]) / (cell * static_cast<float>(right - left)),
            (heights[high] - heights[low]) / (cell * static_cast<float>((high - low) / size))};
  };
  for (size_t i = 0; i < index.size(); ++i) {
    const Vector2f p = place(i);
    const float shade = 0.85F + 0.25F * Fbm(p, 7, 4, options_.seed + 30);
    const float warm = 0.06F * Fbm(p, 11, 3, options_.seed + 31);
    b.set_tint({shade * (1 + warm), shade, shade * (1 - warm), 1});
    const Vector2f s = slope(i);
    index[i] = b.AddVertex({p.x(), p.y(), heights[i]}, Vector3f(-s.x(), -s.y(), 1).normalized(),
                           scale * p.x(), scale * p.y());
  }
  for (size_t y = 0; y + 1 < size; ++y) {
    for (size_t x = 0; x + 1 < size; ++x) {
      const size_t i = y * size + x;
      const Vector2f middle = place(i) + 0.5F * Vector2f(cell, cell);
      if (!holds(middle)) continue;
      MaterialId material =
          Fbm(middle, 9, 5, options_.seed + 40, 0.65F) > 0.35F ? materials.other : materials.open;
      const float ragged = 0.22F * Fbm(middle, 2, 4, options_.seed + 41, 0.8F);
      if (from_trail[i] < Trail::kHalfWidth + ragged) material = materials.trail;
      if (slope(i).norm() + ragged > 0.75F) material = materials.steep;
      b.AddTriangle(material, index[i], index[i + 1], index[i + 1 + size]);
      b.AddTriangle(material, index[i], index[i + 1 + size], index[i + size]);
    }
  }
  b.set_tint({1, 1, 1, 1});
}

void Terrain::AddGround(float reach, const GroundMaterials& materials, MeshBuilder& b) const {
  constexpr float kNear = 0.25F;  // metres between vertices
  constexpr float kFar = 8;
  constexpr float kHorizon = 800;
  AddGrid(reach, kNear, 0, materials, b, [&](const Vector2f&) { return true; });
  // It begins below the near one, so that no gap can be seen.
  AddGrid(kHorizon, kFar, reach, materials, b,
          [&](const Vector2f& p) { return p.cwiseAbs().maxCoeff() > reach - kFar; });
}

}  // namespace orb360::town
