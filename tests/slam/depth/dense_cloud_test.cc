#include "slam/depth/dense_cloud.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/depth/range_room.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::ElementsAre;

/// Views along a line, `spacing` apart, all of which may be compared.
std::vector<DenseView> ViewsOnALine(int count, double spacing) {
  std::vector<DenseView> views(static_cast<size_t>(count));
  for (size_t i = 0; i < views.size(); ++i) {
    views[i].frame_index = static_cast<int>(i);
    views[i].world_from_camera.translation = {spacing * static_cast<double>(i), 0, 0};
    for (size_t j = 0; j < views.size(); ++j) {
      if (j != i) views[i].neighbours.push_back(j);
    }
  }
  return views;
}

TEST(MedianRange, CountsDirectionsNotPixels) {
  // 1 m within 45 degrees of the poles, where half of the pixels are but 29 % of the sphere, and
  // 8 m at the equator.
  cv::Mat range(128, 256, CV_32F, cv::Scalar(1.0));
  range.rowRange(32, 96).setTo(8.0);
  EXPECT_EQ(MedianRange(range), 8.0);
  range.rowRange(32, 96).setTo(0.0);
  EXPECT_EQ(MedianRange(range), 1.0);
  EXPECT_EQ(MedianRange(cv::Mat::zeros(128, 256, CV_32F)), 0.0);
}

TEST(ChooseNeighbours, SpreadsThemFromNearToFarOnBothSides) {
  const std::vector<DenseView> views = ViewsOnALine(101, 0.1);
  // A median of 1.6: 0.2, 0.4, 0.8, 1.6 and 3.2.
  EXPECT_THAT(ChooseNeighbours(views, 50, 1.6, 10),
              ElementsAre(18, 34, 42, 46, 48, 52, 54, 58, 66, 82));
  EXPECT_THAT(ChooseNeighbours(views, 50, 1.6, 2), ElementsAre(42, 58));
  // At the beginning there is only one side.
  EXPECT_THAT(ChooseNeighbours(views, 0, 1.6, 10), ElementsAre(2, 4, 8, 16, 32));
}

TEST(ChooseNeighbours, TakesOnlyThoseWhosePosesFit) {
  std::vector<DenseView> views = ViewsOnALine(5, 1.0);
  views[2].neighbours = {1, 4};
  EXPECT_THAT(ChooseNeighbours(views, 2, 1.0, 10), ElementsAre(1, 4));
}

class FuseCloudTest : public testing::Test {
 protected:
  FuseCloudTest() : views_(ViewsOnALine(9, 0.3)) {
    for (size_t i = 0; i < views_.size(); ++i) {
      views_[i].world_from_camera = TurnedCamera({-1.2 + 0.3 * i, 0.2, 0.1}, 0.1 * i);
      depths_.push_back(room_.Render({128, 64}, views_[i].world_from_camera));
    }
  }

  std::vector<SurfacePoint> Fuse(const DenseCloudOptions& options) {
    std::vector<SurfacePoint> points;
    statistics_ = FuseCloud(
        views_, [this](int frame) { return depths_[static_cast<size_t>(frame)]; }, options,
        [&](std::span<const Voxel> voxels) {
          for (const Voxel& voxel : voxels) {
            points.push_back(MakeSurfacePoint(
                voxel, statistics_.voxel_size > 0 ? statistics_.voxel_size : *options.voxel_size,
                4.0));
          }
        });
    return points;
  }

  RangeRoom room_;
  std::vector<DenseView> views_;
  std::vector<DenseDepth> depths_;
  DenseCloudStatistics statistics_;
};

TEST_F(FuseCloudTest, CoversTheRoomWithItsColoursAndNormals) {
  const std::vector<SurfacePoint> points = Fuse({.voxel_size = 0.1});
  // 82 square metres of walls, 100 voxels each; where a wall lies between voxels, a few more.
  const double expected = 8 * (4.0 * 3 + 4 * 1.5 + 3 * 1.5) * 100;
  EXPECT_GT(static_cast<double>(points.size()), 0.6 * expected);
  EXPECT_LT(static_cast<double>(points.size()), 1.3 * expected);
  int wrong_colour = 0;
  for (const SurfacePoint& point : points) {
    const Eigen::Vector3d position = point.position.cast<double>();
    EXPECT_LT(room_.DistanceFromWalls(position), 0.1);
    EXPECT_LT(point.normal.dot(point.position), 0.1f);  // inward
    EXPECT_GT(point.confidence, 0.5f);
    int axis = 0;
    (room_.half_size - position.cwiseAbs()).minCoeff(&axis);
    wrong_colour += point.rgb[0] != 40 * axis + (position[axis] > 0 ? 100 : 0);
  }
  EXPECT_LT(wrong_colour, 0.1 * static_cast<double>(points.size()));
  EXPECT_EQ(statistics_.views, 9);
}

TEST_F(FuseCloudTest, ColoursAreBroughtToOneWhiteBalance) {
  // Blue counts half in every second view, red in none.
  for (size_t i = 1; i < depths_.size(); i += 2) {
    cv::multiply(depths_[i].color, cv::Scalar(0.5, 1.0, 1.0), depths_[i].color);
  }
  const auto count_odd = [&](const DenseCloudOptions& options) {
    int num_odd = 0;
    for (const SurfacePoint& point : Fuse(options)) {
      if (point.rgb[0] < 100) continue;  // Rounding would count.
      const double ratio = static_cast<double>(point.rgb[2]) / point.rgb[0];
      num_odd += std::abs(ratio - std::pow(0.5, 4.0 / 9.0)) > 0.03;  // Four views of nine.
    }
    return num_odd;
  };
  EXPECT_GT(count_odd({.voxel_size = 0.1, .exposure = std::nullopt}), 1000);
  EXPECT_LT(count_odd({.voxel_size = 0.1}), 100);
}

TEST_F(FuseCloudTest, VoxelsFollowTheRangesOfMapsWithoutMetres) {
  for (DenseView& view : views_) view.world_from_camera.translation *= 1000.0;
  for (DenseDepth& depth : depths_) depth.range *= 1000.0;
  statistics_ = FuseCloud(
      views_, [this](int frame) { return depths_[static_cast<size_t>(frame)]; },
      {.voxel_size = std::nullopt}, [](std::span<const Voxel>) {});
  EXPECT_NEAR(statistics_.voxel_size, 0.01 * MedianRange(depths_[4].range), 2.0);
  EXPECT_GT(statistics_.consistent, 10000);
}

TEST_F(FuseCloudTest, LeavesOutWhatIsFarOrUncertain) {
  for (const SurfacePoint& point : Fuse({.voxel_size = 0.1, .max_range_voxels = 20})) {
    double nearest = 1e9;
    for (const DenseView& view : views_) {
      nearest = std::min(
          nearest, (view.world_from_camera.translation - point.position.cast<double>()).norm());
    }
    EXPECT_LT(nearest, 2.1);
  }
  for (DenseDepth& depth : depths_) depth.confidence.setTo(0.3f);
  EXPECT_TRUE(Fuse({.voxel_size = 0.1, .max_error_voxels = 2}).empty());
}

TEST_F(FuseCloudTest, GivesTheSameInAnyNumberOfPiecesAndKeptViews) {
  const auto all = [this](size_t max_voxels, int max_views) {
    std::map<std::uint64_t, float> information;
    FuseCloud(
        views_, [this](int frame) { return depths_[static_cast<size_t>(frame)]; },
        {.voxel_size = 0.1, .max_neighbours = 4, .max_views = max_views, .max_voxels = max_voxels},
        [&](std::span<const Voxel> voxels) {
          for (const Voxel& voxel : voxels) information[voxel.key] += voxel.information;
        });
    return information;
  };
  const auto whole = all(1'000'000, 48);
  const auto pieces = all(1000, 5);
  ASSERT_EQ(whole.size(), pieces.size());
  for (const auto& [key, information] : whole) {
    ASSERT_NEAR(pieces.at(key), information, 1e-4 * information);
  }
}

TEST_F(FuseCloudTest, GoesOnWhereAViewKnowsNothing) {
  depths_[4].range = 0;
  depths_[8].range = 0;
  EXPECT_GT(Fuse({.voxel_size = 0.1}).size(), 1000u);
  EXPECT_EQ(statistics_.views, 7);
}

TEST_F(FuseCloudTest, ErrorsOfThoseWhoLoadAndTakeComeThrough) {
  const auto load = [this](int frame) { return depths_[static_cast<size_t>(frame)]; };
  for (const int bad : {0, 1, 5, 8}) {
    const auto fail = [&](int frame) {
      if (frame == bad) throw UserError("damaged");
      return load(frame);
    };
    EXPECT_THROW(FuseCloud(views_, fail, {.voxel_size = 0.1}, [](std::span<const Voxel>) {}),
                 UserError)
        << bad;
  }
  for (const size_t max_voxels : {1000, 1'000'000}) {  // in the middle, and at the end
    EXPECT_THROW(FuseCloud(views_, load, {.voxel_size = 0.1, .max_voxels = max_voxels},
                           [](std::span<const Voxel>) { throw UserError("disk full"); }),
                 UserError);
  }
}

TEST_F(FuseCloudTest, NothingGivesNothing) {
  views_.clear();
  EXPECT_TRUE(Fuse({}).empty());
}

}  // namespace
}  // namespace orb360
