#include "slam/io/dense_cloud_file.h"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "slam/io/ply.h"
#include "tests/slam/depth/range_room.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

class DenseCloudFileTest : public testing::Test {
 protected:
  DenseCloudFileTest() : store_(folder_ / "store") {
    const RangeRoom room;
    for (size_t i = 0; i < 6; ++i) {
      DenseView view{static_cast<int>(10 * i),
                     0,
                     TurnedCamera({-1.0 + 0.4 * static_cast<double>(i), 0.2, 0.1},
                                  0.1 * static_cast<double>(i)),
                     {}};
      for (size_t j = 0; j < 6; ++j) {
        if (j != i) view.neighbours.push_back(j);
      }
      store_.Put(view.frame_index, room.Render({128, 64}, view.world_from_camera));
      views_.push_back(view);
    }
  }

  TempFolder folder_;
  DepthMapStore store_;
  std::vector<DenseView> views_;
};

TEST_F(DenseCloudFileTest, ABoundOnMemoryChangesNoPointButByRounding) {
  const DenseCloudSummary whole =
      WriteDenseCloud(folder_ / "whole.ply", store_, views_, {.voxel_size = 0.1});
  const DenseCloudSummary pieces = WriteDenseCloud(folder_ / "pieces.ply", store_, views_,
                                                   {.voxel_size = 0.1, .max_voxels = 500});
  const std::vector<SurfacePoint> expected = ReadSurfacePly(folder_ / "whole.ply");
  const std::vector<SurfacePoint> points = ReadSurfacePly(folder_ / "pieces.ply");
  EXPECT_EQ(whole.points, expected.size());
  EXPECT_EQ(pieces.points, expected.size());
  ASSERT_EQ(points.size(), expected.size());
  EXPECT_GT(points.size(), 4000u);
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_LT((points[i].position - expected[i].position).norm(), 1e-5);
    ASSERT_NEAR(points[i].confidence, expected[i].confidence, 1e-5);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "whole.ply.voxels"));
}

TEST_F(DenseCloudFileTest, GivesTheSameBytesForAnyNumberOfThreads) {
  WriteDenseCloud(folder_ / "one.ply", store_, views_, {.num_threads = 1});
  WriteDenseCloud(folder_ / "three.ply", store_, views_, {.num_threads = 3});
  EXPECT_EQ(ReadText(folder_ / "one.ply"), ReadText(folder_ / "three.ply"));
}

TEST_F(DenseCloudFileTest, ShowsAllPointsToWhoLooks) {
  std::uint64_t shown = 0;
  const DenseCloudSummary summary =
      WriteDenseCloud(folder_ / "a.ply", store_, views_, {},
                      [&](std::span<const SurfacePoint> points) { shown += points.size(); });
  EXPECT_EQ(shown, summary.points);
}

TEST_F(DenseCloudFileTest, NoViewsGiveAnEmptyCloud) {
  EXPECT_EQ(WriteDenseCloud(folder_ / "a.ply", store_, {}, {}).points, 0u);
  EXPECT_TRUE(ReadSurfacePly(folder_ / "a.ply").empty());
}

}  // namespace
}  // namespace orb360
