#include "apps/town/image/paint_nature.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

/// Returns the mean difference between neighbours at a distance of `step` tiles, across the border
/// of the tile or in its middle.
float Difference(const Texture& texture, bool at_border, bool along_x) {
  constexpr int kSamples = 400;
  constexpr float kStep = 2.0F / 1024;
  const float middle = at_border ? 1.0F : 0.37F;
  float sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    const float other = (static_cast<float>(i) + 0.5F) / kSamples;
    const auto at = [&](float x) {
      return along_x ? texture.Sample(x, other, 0).g : texture.Sample(other, x, 0).g;
    };
    sum += std::abs(at(middle + kStep) - at(middle - kStep)) / kSamples;
  }
  return sum;
}

TEST(PaintNature, GroundAndRockTileWithoutASeam) {
  const std::array<Texture, 4> textures = {PaintForestFloor(1, 0.7F, 0.2F), PaintTrail(2),
                                           PaintHeath(3), PaintRock(4)};
  for (size_t i = 0; i < textures.size(); ++i) {
    for (const bool along_x : {false, true}) {
      const float inside = Difference(textures[i], false, along_x);
      EXPECT_GT(inside, 0.002F) << i;
      EXPECT_LT(Difference(textures[i], true, along_x), 1.6F * inside) << i << along_x;
    }
  }
}

TEST(PaintNature, PlantsGrowFromBelowWithinTheirCard) {
  const std::array<Texture, 3> textures = {PaintNeedleBranch(1), PaintFern(2),
                                           PaintGrassTuft(3, 0.5F)};
  for (size_t i = 0; i < textures.size(); ++i) {
    const int size = textures[i].width();
    int covered = 0;
    int at_sides = 0;
    int at_root = 0;
    for (int k = 0; k < size * size; ++k) {
      const float x = (static_cast<float>(k % size) + 0.5F) / static_cast<float>(size);
      const float y = (static_cast<float>(k / size) + 0.5F) / static_cast<float>(size);
      if (!textures[i].Covers(x, y)) continue;
      ++covered;
      at_sides += std::abs(x - 0.5F) > 0.49F || y > 0.99F ? 1 : 0;
      at_root += y < 0.03F && std::abs(x - 0.5F) < 0.2F ? 1 : 0;
    }
    EXPECT_GT(covered, size * size / 20) << i;
    EXPECT_LT(covered, size * size * 3 / 4) << i;
    EXPECT_LT(at_sides, covered / 100) << i;  // else it would end in a straight edge
    EXPECT_GT(at_root, 0) << i;
  }
}

}  // namespace
}  // namespace orb360::town
