#include "slam/io/octree/morton.h"

#include <random>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

/// Bit by bit, as the definition says.
std::uint64_t SlowCode(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint64_t code = 0;
  for (int bit = kMortonBits - 1; bit >= 0; --bit) {
    for (const std::uint32_t value : {x, y, z}) code = code << 1 | (value >> bit & 1);
  }
  return code;
}

TEST(Morton, InterleavesTheBitsOfThreeNumbersAndTakesThemApart) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t x = random() >> 11, y = random() >> 11, z = random() >> 11;
    const std::uint64_t code = MortonCode(x, y, z);
    ASSERT_EQ(code, SlowCode(x, y, z));
    ASSERT_EQ(GatherBits(code >> 2), x);
    ASSERT_EQ(GatherBits(code >> 1), y);
    ASSERT_EQ(GatherBits(code), z);
  }
}

TEST(Morton, PutsPositionsOutsideTheCubeIntoItsNearestCell) {
  const Eigen::Vector3d min(1, 2, 3);
  EXPECT_EQ(MortonCode(Eigen::Vector3d(0, 0, 0), min, 2), 0U);
  EXPECT_EQ(MortonCode(Eigen::Vector3d(9, 9, 9), min, 2), (std::uint64_t{1} << 63) - 1);
  EXPECT_EQ(MortonCode(min + Eigen::Vector3d(1, 0, 0), min, 2), std::uint64_t{4} << 60);
}

TEST(Morton, CountsTheDigitsThatCodesShare) {
  EXPECT_EQ(CommonDigits(5, 5), kMortonBits);
  EXPECT_EQ(CommonDigits(0, 7), kMortonBits - 1);
  EXPECT_EQ(CommonDigits(0, 8), kMortonBits - 2);
  EXPECT_EQ(CommonDigits(0, std::uint64_t{1} << 62), 0);
  EXPECT_EQ(CommonDigits(0, std::uint64_t{1} << 60), 0);
  EXPECT_EQ(CommonDigits(0, std::uint64_t{1} << 59), 1);
}

}  // namespace
}  // namespace orb360
