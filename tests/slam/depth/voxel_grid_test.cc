#include "slam/depth/voxel_grid.h"

#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

const Eigen::Vector3f kUp(0, 0, 1);

void AddOne(const VoxelSample& sample, int view, VoxelGrid* grid) { grid->Add({&sample, 1}, view); }

TEST(VoxelGrid, APointIsTheMeanWeightedByCertainty) {
  VoxelGrid grid(0.1);
  // Below zero, where rounding is easily wrong. The second is twice as certain: four times the
  // weight.
  AddOne({{-0.31, 0.52, 7.04}, {0, 0, 1}, {10, 20, 30}, 0.02f}, 0, &grid);
  AddOne({{-0.36, 0.57, 7.09}, {1, 0, 0}, {60, 120, 80}, 0.01f}, 1, &grid);
  const std::vector<Voxel> voxels = grid.TakeAll();
  ASSERT_EQ(voxels.size(), 1u);
  const SurfacePoint point = MakeSurfacePoint(voxels[0], 0.1, 100.0);
  EXPECT_LT((point.position - Eigen::Vector3f(-0.35f, 0.56f, 7.08f)).norm(), 1e-5);
  EXPECT_LT((point.normal - Eigen::Vector3f(4, 0, 1).normalized()).norm(), 1e-6);
  EXPECT_EQ(point.rgb, (std::array<std::uint8_t, 3>{50, 100, 70}));
  // Variances 4e-4 and 1e-4 together are 8e-5: 0.0894 voxels.
  EXPECT_NEAR(1.0 / point.confidence - 1.0, std::sqrt(8e-5) / 0.1, 1e-5);
  // Bounded by that of the better one.
  EXPECT_NEAR(1.0 / MakeSurfacePoint(voxels[0], 0.1, 1.0).confidence - 1.0, 0.1, 1e-5);
  EXPECT_EQ(grid.num_voxels(), 0u);
}

TEST(VoxelGrid, HoldsWhatAMapHolds) {
  VoxelGrid grid(1.0);
  std::map<std::array<int, 3>, int> counts;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> index(-40, 40);
  for (int i = 0; i < 300000; ++i) {  // Grows several times.
    const std::array<int, 3> cell{index(random), index(random), index(random)};
    ++counts[cell];
    AddOne({{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}, kUp, {}, 1.0f}, i, &grid);
  }
  EXPECT_EQ(grid.num_voxels(), counts.size());
  const std::vector<Voxel> voxels = grid.TakeAll();
  ASSERT_EQ(voxels.size(), counts.size());
  for (size_t i = 0; i < voxels.size(); ++i) {
    if (i > 0) {
      ASSERT_LT(voxels[i - 1].key, voxels[i].key);
    }
    const SurfacePoint point = MakeSurfacePoint(voxels[i], 1.0, 1.0);
    const std::array<int, 3> cell{static_cast<int>(std::floor(point.position.x())),
                                  static_cast<int>(std::floor(point.position.y())),
                                  static_cast<int>(std::floor(point.position.z()))};
    ASSERT_FLOAT_EQ(voxels[i].information, static_cast<float>(counts.at(cell)));
  }
}

TEST(VoxelGrid, ManyAtOnceAreTheSameAsOneByOne) {
  VoxelGrid together(1.0);
  VoxelGrid alone(1.0);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-12.0, 12.0);
  std::vector<VoxelSample> samples;
  for (int i = 0; i < 100003; ++i) {  // Several in a voxel, also close behind each other.
    const Eigen::Vector3d position(place(random), place(random), i % 50 == 0 ? 1e9 : 0.5);
    samples.push_back({position, kUp, {static_cast<std::uint8_t>(i % 256), 0, 9}, 0.5f});
    AddOne(samples.back(), 7, &alone);
  }
  together.Add(samples, 7);
  const std::vector<Voxel> expected = alone.TakeAll();
  const std::vector<Voxel> voxels = together.TakeAll();
  ASSERT_EQ(voxels.size(), 24u * 24u);
  ASSERT_EQ(voxels.size(), expected.size());
  for (size_t i = 0; i < voxels.size(); ++i) {
    ASSERT_EQ(voxels[i].key, expected[i].key);
    ASSERT_EQ(voxels[i].information, expected[i].information);
    ASSERT_EQ(voxels[i].offset, expected[i].offset);
    ASSERT_EQ(voxels[i].rgb, expected[i].rgb);
    ASSERT_EQ(voxels[i].last_view, 7);
  }
}

TEST(VoxelGrid, GivesTheOldestHalfAndKeepsTheRest) {
  VoxelGrid grid(1.0);
  for (int view = 0; view < 100; ++view) AddOne({{view + 0.5, 0, 0}, kUp, {}, 1.0f}, view, &grid);
  AddOne({{0.5, 0, 0}, kUp, {}, 1.0f}, 100, &grid);  // The oldest becomes the newest.
  const std::vector<Voxel> old = grid.TakeOldest();
  EXPECT_GE(old.size(), 50u);
  EXPECT_LE(old.size(), 51u);
  for (const Voxel& voxel : old) EXPECT_LE(voxel.last_view, 51);
  const std::vector<Voxel> rest = grid.TakeAll();
  EXPECT_EQ(old.size() + rest.size(), 100u);
  for (const Voxel& voxel : rest) EXPECT_GT(voxel.last_view, 50);
}

TEST(VoxelGrid, PartsOfAVoxelAddUp) {
  VoxelGrid parts(0.05);
  VoxelGrid whole(0.05);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0.0f, 0.05f);
  Voxel sum;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d position(place(random), place(random), place(random));
    const std::array<std::uint8_t, 3> rgb{static_cast<std::uint8_t>(i), 0, 255};
    AddOne({position, kUp, rgb, 0.01f}, i, &whole);
    AddOne({position, kUp, rgb, 0.01f}, i, &parts);
    for (const Voxel& part : parts.TakeAll()) {
      if (i == 0) sum = part;
      if (i != 0) sum += part;
    }
  }
  const SurfacePoint expected = MakeSurfacePoint(whole.TakeAll()[0], 0.05, 4.0);
  const SurfacePoint point = MakeSurfacePoint(sum, 0.05, 4.0);
  EXPECT_EQ(point.position, expected.position);
  EXPECT_EQ(point.rgb, expected.rgb);
  EXPECT_EQ(point.confidence, expected.confidence);
}

TEST(VoxelGrid, LeavesOutWhatIsTooFarAway) {
  VoxelGrid grid(0.05);
  AddOne({{1e9, 0, 0}, kUp, {}, 1.0f}, 0, &grid);
  AddOne({{0, std::numeric_limits<double>::quiet_NaN(), 0}, kUp, {}, 1.0f}, 0, &grid);
  EXPECT_EQ(grid.num_voxels(), 0u);
  AddOne({{-50000, 50000, 0}, kUp, {}, 1.0f}, 0, &grid);
  EXPECT_LT(
      (MakeSurfacePoint(grid.TakeAll()[0], 0.05, 1).position - Eigen::Vector3f(-50000, 50000, 0))
          .norm(),
      0.05);
}

TEST(VoxelGrid, TilesAreCubesOfVoxels) {
  VoxelGrid grid(1.0);
  const auto tile = [&grid](double x, double y, double z) {
    AddOne({{x, y, z}, kUp, {}, 1.0f}, 0, &grid);
    return VoxelTile(grid.TakeAll()[0].key);
  };
  EXPECT_EQ(tile(0.5, 0.5, 0.5), tile(255.5, 255.5, 255.5));
  EXPECT_NE(tile(0.5, 0.5, 0.5), tile(256.5, 0.5, 0.5));
  EXPECT_NE(tile(0.5, 0.5, 0.5), tile(0.5, -0.5, 0.5));
}

}  // namespace
}  // namespace orb360
