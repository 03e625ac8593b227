#include "slam/pipeline/dense_views.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

FramePose FrameAt(int index, int reference, int map = 0) {
  const Eigen::Vector3d position(0.1 * index, 0, 0);
  return {.index = index,
          .timestamp = 0.1 * index,
          .map = map,
          .world_from_camera = {Eigen::Quaterniond::Identity(), position},
          .reference = reference};
}

/// Frames 0, 5 ... 30, of which 0, 10, 20 and 30 are keyframes and 10 has no depth.
Reconstruction FourKeyframes() {
  Reconstruction result;
  for (int i = 0; i <= 30; i += 5) result.frames.push_back(FrameAt(i, i / 10 * 10));
  for (int i = 0; i <= 30; i += 10) result.keyframes.push_back(FrameAt(i, i));
  result.covisibility = {{0, 1, 50}, {1, 2, 50}, {2, 3, 50}};
  result.maps.push_back({.is_metric = true});
  return result;
}

bool HasDepth(int frame_index) { return frame_index % 10 == 0 && frame_index != 10; }

TEST(MakeDenseViews, AreTheFramesWithDepthInTheGivenWorld) {
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

TEST(MakeDenseViews, FramesAreNeighboursWhereTheirKeyframesSeeTheSameLandmarks) {
  const auto is_view = [](int frame_index) { return frame_index != 10; };
  const std::vector<DenseView> views = MakeDenseViews(FourKeyframes(), Rigid3(), is_view);
  ASSERT_EQ(views.size(), 6u);                                  // 0, 5, 15, 20, 25, 30
  EXPECT_EQ(views[0].neighbours, (std::vector<size_t>{1, 2}));  // 20 sees other landmarks
  EXPECT_EQ(views[1].neighbours, (std::vector<size_t>{0, 2}));
  EXPECT_EQ(views[2].neighbours, (std::vector<size_t>{0, 1, 3, 4}));  // 15 goes with 10
  EXPECT_EQ(views[5].neighbours, (std::vector<size_t>{3, 4}));
}

TEST(MakeDenseViews, AreNotThoseWhoseImagesShowedNothing) {
  Reconstruction reconstruction = FourKeyframes();
  reconstruction.frames[1].is_interpolated = true;
  const auto all = [](int) { return true; };
  EXPECT_EQ(MakeDenseViews(reconstruction, Rigid3(), all)[1].frame_index, 10);
}

TEST(MakeDenseViews, OfDifferentMapsAreNoNeighbours) {
  Reconstruction reconstruction = FourKeyframes();
  reconstruction.maps.push_back({.is_metric = true});
  for (const int index : {22, 28}) {
    reconstruction.frames.push_back(FrameAt(index, index, 1));
    reconstruction.keyframes.push_back(FrameAt(index, index, 1));
  }
  reconstruction.covisibility.push_back({4, 5, 50});
  std::ranges::sort(reconstruction.frames, {}, &FramePose::index);
  const std::vector<DenseView> views =
      MakeDenseViews(reconstruction, Rigid3(), [](int frame_index) { return frame_index > 20; });
  ASSERT_EQ(views.size(), 4u);  // 22, 25, 28, 30
  EXPECT_EQ(views[0].neighbours, std::vector<size_t>{2});
  EXPECT_EQ(views[1].neighbours, std::vector<size_t>{3});
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
