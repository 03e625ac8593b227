#include "slam/scale/shift_polynomial.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

constexpr double kCell = 0.02;

// Shifts of 6 x 10 tiles by a curved road, with noise of `noise` cells, seen through lenses
// `lens_distance` apart. Tiles nearer than `half_step` pass from one lens to the other.
std::vector<TileShift> Tiles(double half_step, double lens_distance, double noise,
                             unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  std::vector<TileShift> tiles;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 10; ++column) {
      const double x = 0.32 * (row - 2.5);
      const double y = 0.32 * (column - 4.5);
      const double per_lens_distance = std::abs(x) < half_step ? -1 / kCell : 0.0;
      tiles.push_back({{x, y},
                       40 + 2 * x - y + 1.5 * x * x - 0.5 * x * y + y * y +
                           lens_distance * per_lens_distance + normal(random),
                       per_lens_distance});
    }
  }
  return tiles;
}

TEST(FitShifts, GivesTheShiftAndItsSlopeBelow) {
  const auto fit = FitShifts(Tiles(0.4, 0, 1e-6), 0, 12);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shift, 40, 1e-4);
  EXPECT_NEAR(fit->gradient.x(), 2, 1e-4);
  EXPECT_NEAR(fit->gradient.y(), -1, 1e-4);
  EXPECT_EQ(fit->num_tiles, 60);
}

TEST(FitShifts, LeavesOutWhatMoves) {
  std::vector<TileShift> tiles = Tiles(0.4, 0, 0.05);
  for (size_t i = 3; i < 60; i += 10) tiles[i].shift += 3;
  const auto fit = FitShifts(tiles, 0, 12);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shift, 40, 0.2);
  EXPECT_LE(fit->num_tiles, 54);
  tiles.resize(11);
  EXPECT_FALSE(FitShifts(tiles, 0, 11));
}

TEST(FitShifts, UndoesTheDistanceBetweenTheLenses) {
  const double distance = 0.02;
  const std::vector<TileShift> tiles = Tiles(0.4, distance, 1e-6);
  const auto with = FitShifts(tiles, distance, 12);
  ASSERT_TRUE(with);
  EXPECT_NEAR(with->shift, 40, 1e-4);
  const auto without = FitShifts(tiles, 0, 12);
  ASSERT_TRUE(without);
  EXPECT_GT(std::abs(without->shift - 40), 0.3);
  EXPECT_NEAR(without->shift + distance * without->per_lens_distance, 40, 1e-4);
}

TEST(FitLensDistance, IsWithinItsSigma) {
  double squares = 0;
  constexpr int kCount = 40;
  for (unsigned seed = 0; seed < kCount; ++seed) {
    const LensDistance found = FitLensDistance(Tiles(0.4, 0.015, 0.1, seed), 12);
    ASSERT_GT(found.sigma, 0) << seed;
    squares += std::pow((found.value - 0.015) / found.sigma, 2);
  }
  // Sigma is twice that of independent tiles.
  EXPECT_NEAR(squares / kCount, 0.25, 0.15);
}

TEST(FitLensDistance, IsUnknownWhereAllTilesOrNonePassFromOneLensToTheOther) {
  EXPECT_EQ(FitLensDistance(Tiles(2.0, 0.02, 0.1), 12).sigma, 0);
  EXPECT_EQ(FitLensDistance(Tiles(0.0, 0.0, 0.1), 12).sigma, 0);
}

}  // namespace
}  // namespace orb360
