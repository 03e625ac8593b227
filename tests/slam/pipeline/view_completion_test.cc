#include "slam/pipeline/view_completion.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/depth/driving_scene.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/pipeline/propagation_network.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);

RangeSource SourceAt(const DenseDepth& depth, int row, int column) {
  return static_cast<RangeSource>(depth.source.at<std::uint8_t>(row, column));
}

cv::Mat AllFrom(RangeSource source) {
  return {kCamera.height(), kCamera.width(), CV_8U, cv::Scalar(static_cast<double>(source))};
}

// Nine views 2 m apart. A car drives beside the camera; the fifth view is at the origin.
class CompleteViewsTest : public testing::Test {
 protected:
  CompleteViewsTest()
      : first_(folder_ / "first"),
        store_(folder_ / "depth"),
        images_(folder_ / "images"),
        completer_(WritePropagation(folder_),
                   {.size = {kCamera.width(), kCamera.height()}, .threads = 1}) {
    for (int i = 0; i < 9; ++i) {
      const double x = 2.0 * (i - 4);
      views_.push_back(
          {.frame_index = 10 * i, .world_from_camera = scene_.CameraAt(x), .neighbours = {}});
      images_.Put(10 * i, cv::Mat(kCamera.height(), kCamera.width(), CV_8UC3, cv::Scalar::all(90)));
      if (i != 7) first_.Put(10 * i, scene_.Render(kCamera, x));
    }
  }

  int Complete(const std::optional<Eigen::Vector3d>& up, const ViewDepthCallbacks& callbacks = {},
               const ViewDepthOptions& options = {}) {
    const auto all_others = [this](size_t view) {
      std::vector<size_t> others;
      for (size_t i = 0; i < views_.size(); ++i) {
        if (i != view) others.push_back(i);
      }
      return others;
    };
    return CompleteViews(
        views_, all_others, [](const DenseView&) { return std::vector<SparsePoint>(); }, up,
        options, images_, &completer_, 2, first_, store_, callbacks);
  }

  // The depth at the origin in the direction of a point.
  float RangeAt(const Eigen::Vector3d& point, const DepthMapStore& store) const {
    const Eigen::Vector2d pixel = kCamera.Project(point);
    return store.Get(40).range.at<float>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()));
  }

  static inline const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();
  static inline const Eigen::Vector3d kOnCar{0, 4, -0.5};
  TempFolder folder_;
  DepthMapStore first_;
  DepthMapStore store_;
  ImageStore images_;
  DepthCompleter completer_;
  DrivingScene scene_{.box = MovingBox{{-2, 4, -DrivingScene::kHeight}, {4.5, 1.8, 1.5}, 0.75}};
  std::vector<DenseView> views_;
};

TEST_F(CompleteViewsTest, AnObjectThatMovesAlongIsPutOnTheGround) {
  EXPECT_GT(RangeAt(kOnCar, first_), 15);
  EXPECT_GT(Complete(kUp), 4);
  EXPECT_NEAR(RangeAt(kOnCar, store_), kOnCar.norm(), 0.5);
  const Eigen::Vector2d pixel = kCamera.Project(kOnCar);
  EXPECT_EQ(SourceAt(store_.Get(40), static_cast<int>(pixel.y()), static_cast<int>(pixel.x())),
            RangeSource::kMovingObject);
  EXPECT_FALSE(store_.Contains(70));
}

TEST_F(CompleteViewsTest, WithoutAKnownGroundItStaysWhereStereoSeesIt) {
  EXPECT_EQ(Complete(std::nullopt), 0);
  EXPECT_EQ(RangeAt(kOnCar, store_), RangeAt(kOnCar, first_));
}

TEST_F(CompleteViewsTest, WithoutCompletionAnObjectThatMovesAlongIsUnknown) {
  Complete(kUp, {}, {.keeps_completed = false});
  EXPECT_EQ(RangeAt(kOnCar, store_), 0);
  EXPECT_GT(RangeAt({1, -3, -DrivingScene::kHeight}, store_), 0);
}

TEST_F(CompleteViewsTest, WhatWasMeasuredStays) {
  Complete(kUp);
  const Eigen::Vector3d on_ground(1, -3, -DrivingScene::kHeight);
  EXPECT_EQ(RangeAt(on_ground, store_), RangeAt(on_ground, first_));
}

TEST_F(CompleteViewsTest, BesideTheEdgeOfANearSurfaceTheRangeStaysAsThatOfABoundary) {
  // A post in front of the right side of the road, as wide as five pixels and another three grown.
  constexpr int kTop = 60;
  DenseDepth depth = scene_.Render(kCamera, 0);
  depth.range(cv::Rect(150, kTop, 11, 40)).setTo(1.0F);
  first_.Put(40, depth);
  Complete(kUp);
  const DenseDepth completed = store_.Get(40);
  for (int column = 150; column < 161; ++column) {
    const bool is_beside = column < 153 || column >= 158;
    EXPECT_NEAR(completed.range.at<float>(kTop + 20, column), 1, 0.01) << column;
    EXPECT_EQ(SourceAt(completed, kTop + 20, column),
              is_beside ? RangeSource::kBoundary : RangeSource::kMeasured)
        << column;
    EXPECT_EQ(completed.confidence.at<float>(kTop + 20, column) > 0.9, !is_beside) << column;
  }
}

TEST_F(CompleteViewsTest, WhatTheNetworkHardlyKnowsMayBeTheSkyBehindAnEdge) {
  // Every range is 3 m, but that of a rectangle only is measured; the network gives the rest the
  // same and is not sure.
  const cv::Size size(kCamera.width(), kCamera.height());
  for (int i = 0; i < 9; ++i) {
    DenseDepth depth{cv::Mat(size, CV_32F, cv::Scalar(3)), cv::Mat(size, CV_32F, cv::Scalar(0.4)),
                     cv::Mat(size, CV_8UC3, cv::Scalar::all(90)), AllFrom(RangeSource::kCompleted)};
    if (i == 4) {
      const cv::Rect measured(100, 50, 40, 30);
      depth.confidence(measured).setTo(0.98);
      depth.source(measured).setTo(static_cast<double>(RangeSource::kMeasured));
    }
    first_.Put(10 * i, depth);
  }
  Complete(std::nullopt);
  const DenseDepth completed = store_.Get(40);
  for (const int column : {102, 137}) {
    EXPECT_NEAR(completed.range.at<float>(65, column), 3, 0.01);
    EXPECT_EQ(SourceAt(completed, 65, column), RangeSource::kBoundary);
  }
  EXPECT_EQ(SourceAt(completed, 65, 120), RangeSource::kMeasured);
  EXPECT_GT(completed.confidence.at<float>(65, 120), 0.97);
}

TEST_F(CompleteViewsTest, AViewGetsPointsThatOthersMeasured) {
  // The first pass saw nothing at the right and has put it near.
  DenseDepth depth = scene_.Render(kCamera, 0);
  const cv::Rect right(150, 70, 40, 40);
  depth.range(right) = 0.5;
  depth.confidence(right) = 0.6;
  depth.source(right) = static_cast<double>(RangeSource::kCompleted);
  first_.Put(40, depth);
  int num_points = 0;
  Complete(kUp, {.sink = [&](const SparseSample& sample) {
             if (sample.frame_index != 40) return;
             for (int row = right.y; row < right.br().y; ++row) {
               for (int column = right.x; column < right.br().x; ++column) {
                 const float range = sample.sparse.range.at<float>(row, column);
                 if (!(range > 0)) continue;
                 ++num_points;
                 // A pixel is 1.4 degrees high.
                 const double truth = scene_.Range(0, kCamera.Bearing({column + 0.5, row + 0.5}));
                 EXPECT_NEAR(range / truth, 1, 0.1) << row << " " << column;
               }
             }
           }});
  EXPECT_GT(num_points, 10);
}

TEST_F(CompleteViewsTest, BelowACameraOfKnownHeightTheNetworkIsGivenTheGroundThatNobodyMeasured) {
  const cv::Rect below(0, 90, kCamera.width(), kCamera.height() - 90);
  for (int i = 0; i < 9; ++i) {
    DenseDepth depth = scene_.Render(kCamera, 2.0 * (i - 4));
    depth.range(below) = 20;
    depth.confidence(below) = 0.6;
    depth.source(below) = static_cast<double>(RangeSource::kCompleted);
    first_.Put(10 * i, depth);
  }
  const cv::Rect steep(0, 112, kCamera.width(), kCamera.height() - 112);  // 67 degrees down
  int num_points = 0;
  const ViewDepthCallbacks callbacks{.sink = [&](const SparseSample& sample) {
    for (int row = steep.y; row < steep.br().y; ++row) {
      const double down = -kCamera.Bearing({0.5, row + 0.5}).z();
      for (int column = 0; column < kCamera.width(); ++column) {
        const float range = sample.sparse.range.at<float>(row, column);
        if (!(range > 0)) continue;
        ++num_points;
        EXPECT_NEAR(range * down, DrivingScene::kHeight, 0.01);
      }
    }
  }};
  Complete(kUp, callbacks);
  EXPECT_LT(num_points, 20);  // Of what lies above that.
  num_points = 0;
  ViewDepthOptions options;
  options.camera_height = DrivingScene::kHeight;
  Complete(kUp, callbacks, options);
  EXPECT_GT(num_points, 100);
}

TEST_F(CompleteViewsTest, WithoutStereoNothingIsTakenToBeMeasured) {
  int num_points = 0;
  Complete(std::nullopt,
           {.sink =
                [&](const SparseSample& sample) {
                  num_points += cv::countNonZero(sample.sparse.range);
                }},
           {.baselines = {}});
  EXPECT_EQ(num_points, 0);
  EXPECT_EQ(RangeAt(kOnCar, store_), RangeAt(kOnCar, first_));
}

TEST_F(CompleteViewsTest, AnInterruptKeepsTheDepthOfTheFirstPass) {
  int num_calls = 0;
  EXPECT_EQ(Complete(kUp, {.progress =
                               [&](int done, int count) {
                                 EXPECT_EQ(done, 9 + num_calls++);
                                 EXPECT_EQ(count, 18);
                                 return false;
                               }}),
            0);
  EXPECT_EQ(num_calls, 9);
  EXPECT_EQ(RangeAt(kOnCar, store_), RangeAt(kOnCar, first_));
}

}  // namespace
}  // namespace orb360
