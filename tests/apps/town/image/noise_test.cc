#include "apps/town/image/noise.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(Noise, TilesWithoutASeam) {
  for (const float t : {0.0F, 0.13F, 0.5F, 0.77F}) {
    constexpr float kEdge = 1e-5F;
    EXPECT_NEAR(TiledFbm(t, 0, 8, 5, 3), TiledFbm(t, 1 - kEdge, 8, 5, 3), 1e-2F);
    EXPECT_NEAR(TiledFbm(0, t, 8, 5, 3), TiledFbm(1 - kEdge, t, 8, 5, 3), 1e-2F);
    EXPECT_NEAR(TiledCells(t, 0, 6, 3).nearest, TiledCells(t, 1 - kEdge, 6, 3).nearest, 1e-3F);
  }
}

TEST(Noise, HasMeanZeroAndBoundedValues) {
  double sum = 0;
  constexpr int kSteps = 200;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const float value = TiledFbm((static_cast<float>(i) + 0.5F) / kSteps,
                                   (static_cast<float>(j) + 0.5F) / kSteps, 16, 4, 11);
      EXPECT_LT(std::abs(value), 2.0F);
      sum += value;
    }
  }
  EXPECT_NEAR(sum / (kSteps * kSteps), 0, 0.05);
}

TEST(Noise, DiffersBetweenSeeds) {
  double difference = 0;
  for (int i = 0; i < 100; ++i) {
    const float x = static_cast<float>(i) / 100;
    difference += std::abs(TiledFbm(x, 0.3F, 8, 3, 1) - TiledFbm(x, 0.3F, 8, 3, 2));
  }
  EXPECT_GT(difference, 10);
}

TEST(Noise, CellsFindTheNearestBeforeTheSecond) {
  for (int i = 0; i < 500; ++i) {
    const Cell cell = TiledCells(LatticeValue(i, 0, 1), LatticeValue(i, 1, 1), 9, 5);
    EXPECT_LE(cell.nearest, cell.second);
    EXPECT_LT(cell.nearest, 1.5F);
  }
}

}  // namespace
}  // namespace orb360::town
