#include "slam/pipeline/dense_views.h"

#include <vector>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

/// Keyframes 0, 10, 20 and 30 in a row, of which 10 has no depth.
Reconstruction FourKeyframes() {
  Reconstruction result;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d position(i, 0, 0);
    result.keyframes.push_back({.index = 10 * i,
                                .timestamp = 1.0 * i,
                                .map = 0,
                                .world_from_camera = {Eigen::Quaterniond::Identity(), position}});
  }
  result.covisibility = {{0, 1, 50}, {1, 2, 50}, {2, 3, 50}};
  result.maps.push_back({.is_metric = true});
  return result;
}

bool HasDepth(int frame_index) { return frame_index != 10; }

TEST(MakeDenseViews, AreTheKeyframesWithDepthInTheGivenWorld) {
  const Rigid3 target{ExpSo3({0, 0, 0.5}), {5, 6, 7}};
  const std::vector<DenseView> views = MakeDenseViews(FourKeyframes(), target, HasDepth);
  ASSERT_EQ(views.size(), 3u);
  EXPECT_EQ(views[1].frame_index, 20);
  EXPECT_LT((views[1].world_from_camera.translation - target * Eigen::Vector3d(2, 0, 0)).norm(),
            1e-12);
}

TEST(MakeDenseViews, AreNeighboursWhereBothHaveDepthAndSeeTheSameLandmarks) {
  const std::vector<DenseView> views = MakeDenseViews(FourKeyframes(), Rigid3(), HasDepth);
  EXPECT_TRUE(views[0].neighbours.empty());  // its only neighbour has no depth
  EXPECT_EQ(views[1].neighbours, std::vector<size_t>{2});
  EXPECT_EQ(views[2].neighbours, std::vector<size_t>{1});
}

TEST(CloudOptionsFor, VoxelsHaveASizeInMetresOnlyWhereTheMapIsInMetres) {
  Reconstruction reconstruction = FourKeyframes();
  EXPECT_TRUE(CloudOptionsFor(reconstruction, 3).voxel_size.has_value());
  EXPECT_EQ(CloudOptionsFor(reconstruction, 3).num_threads, 3);
  reconstruction.maps.front().is_metric = false;
  EXPECT_FALSE(CloudOptionsFor(reconstruction, 3).voxel_size.has_value());
}

}  // namespace
}  // namespace orb360
