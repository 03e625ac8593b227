#include "slam/pipeline/stereo_depth.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include "tests/slam/geometry/box_room.h"
#include "tests/slam/pipeline/propagation_network.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

// Views along the x axis at these places, in the order of the path; all are neighbours.
std::vector<DenseView> ViewsAt(const std::vector<double>& places) {
  std::vector<DenseView> views;
  for (size_t i = 0; i < places.size(); ++i) {
    const auto angle = static_cast<double>(i);
    views.push_back({.frame_index = static_cast<int>(10 * i),
                     .world_from_camera = {ExpSo3({0.1, 0.2, 0.3 * angle}), {places[i], 0, 0}},
                     .scale = 2.0,
                     .neighbours = {}});
    for (size_t j = 0; j < places.size(); ++j) {
      if (j != i) views.back().neighbours.push_back(j);
    }
  }
  return views;
}

std::vector<int> Indices(const std::vector<FramePose>& frames) {
  std::vector<int> indices;
  for (const FramePose& frame : frames) indices.push_back(frame.index);
  return indices;
}

FramePose FrameAt(int index, double place, int map = 0) {
  return {index, 0.1 * index, map, {Eigen::Quaterniond::Identity(), {place, 0, 0}}};
}

TEST(ChooseStereoSources, TakesTheNearestToEachBaselineOnBothSides) {
  const std::vector<DenseView> views = ViewsAt({-5, -1.4, -0.5, -0.02, 0, 0.02, 0.5, 1.4, 5});
  const StereoDepthOptions options{.baselines = {0.1, 0.3}, .max_baseline_ratio = 2.0};
  const auto choose = [&](size_t view) {
    return Indices(
        ChooseStereoSources(FindStereoCandidates(views, view, {}), views[view], 5.0, options));
  };
  EXPECT_EQ(choose(4), (std::vector<int>{20, 60, 10, 70}));
  EXPECT_EQ(choose(0), std::vector<int>{});
}

TEST(ChooseStereoSources, TakesNoViewFromTheSamePlaceNorOneThatSeesNothingOfIt) {
  std::vector<DenseView> views = ViewsAt({0, 0, 0.5, 0.6});
  views[0].neighbours = {1, 3};
  EXPECT_EQ(Indices(ChooseStereoSources(FindStereoCandidates(views, 0, {}), views[0], 5.0,
                                        {.baselines = {0.1, 0.12}})),
            std::vector<int>{30});
}

TEST(FindStereoCandidates, AreNeighboursAndTheFramesOfTheMapBetweenThem) {
  std::vector<DenseView> views = ViewsAt({0, 1, 2, 3, 4, 5});
  views[1].neighbours = {5, 4, 2};
  const std::vector<FramePose> frames = {FrameAt(5, 0.5),     FrameAt(10, 1), FrameAt(12, 1.2),
                                         FrameAt(15, 1.5, 1), FrameAt(20, 2), FrameAt(25, 2.5),
                                         FrameAt(45, 4.5)};
  EXPECT_EQ(Indices(FindStereoCandidates(views, 1, frames)),
            (std::vector<int>{12, 20, 40, 45, 50}));
}

class MeasureDepthTest : public testing::Test {
 protected:
  MeasureDepthTest()
      : store_(folder_ / "depth"),
        images_(folder_ / "depth" / "images"),
        completer_(WritePropagation(folder_),
                   {.size = {kCamera.width(), kCamera.height()}, .threads = 1}) {}

  // Stores images of the room, each with the same wrong range everywhere.
  void Store(const std::vector<DenseView>& views) {
    for (const DenseView& view : views) {
      const cv::Size size(kCamera.width(), kCamera.height());
      store_.Put(view.frame_index, {cv::Mat(size, CV_32F, 1.2), cv::Mat(size, CV_32F, 0.9),
                                    kRoom.Render(kCamera, view.world_from_camera)});
    }
  }

  // Median of |ln| of the ratio of a view's ranges to the truth.
  double MedianError(const DenseView& view) {
    const cv::Mat range = store_.Get(view.frame_index).range;
    std::vector<double> errors;
    for (int row = 30; row < range.rows - 30; row += 3) {
      for (int column = 0; column < range.cols; column += 3) {
        const Eigen::Vector3d ray =
            view.world_from_camera.rotation * kCamera.Bearing({column + 0.5, row + 0.5});
        const double truth = kRoom.Range(view.world_from_camera.translation, ray);
        errors.push_back(std::abs(std::log(view.scale * range.at<float>(row, column) / truth)));
      }
    }
    return Median(errors);
  }

  static inline const EquirectangularCamera kCamera{256, 128};
  static inline const BoxRoom kRoom{{4.0, 3.0, 2.0}, 3};
  TempFolder folder_;
  DepthMapStore store_;
  GrayImageStore images_;
  DepthCompleter completer_;
};

TEST_F(MeasureDepthTest, RangesAreMeasuredInTheUnitOfEachKeyframe) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  Store(views);
  EXPECT_GT(MedianError(views[1]), 0.2);
  EXPECT_EQ(MeasureDepth(views, {}, {}, store_, images_, &completer_, 2), 4);
  for (const DenseView& view : views) EXPECT_LT(MedianError(view), 0.05) << view.frame_index;
}

TEST_F(MeasureDepthTest, AKeyframeWithoutTwoSourcesStaysAsItWasCompleted) {
  const std::vector<DenseView> views = ViewsAt({0, 0.3});
  Store(views);
  EXPECT_EQ(MeasureDepth(views, {}, {}, store_, images_, &completer_, 2), 0);
  EXPECT_NEAR(store_.Get(0).range.at<float>(60, 100), 1.2, 0.001);
}

TEST_F(MeasureDepthTest, FramesThatAreNoKeyframesAreSources) {
  const std::vector<DenseView> views = ViewsAt({0, 0.6});
  Store(views);
  EXPECT_EQ(MeasureDepth(views, {}, {}, store_, images_, &completer_, 2), 0);
  const FramePose between = FrameAt(5, 0.3);
  cv::Mat gray;
  cv::cvtColor(kRoom.Render(kCamera, between.world_from_camera), gray, cv::COLOR_BGR2GRAY);
  images_.Put(between.index, gray);
  EXPECT_EQ(MeasureDepth(views, {{between}}, {}, store_, images_, &completer_, 2), 2);
  for (const DenseView& view : views) EXPECT_LT(MedianError(view), 0.05) << view.frame_index;
}

TEST_F(MeasureDepthTest, AKeyframeOfWhichLittleIsSeenStaysAsItWasCompleted) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  Store(views);
  EXPECT_EQ(MeasureDepth(views, {}, {.min_fraction = 0.999}, store_, images_, &completer_, 2), 0);
  EXPECT_NEAR(store_.Get(0).range.at<float>(60, 100), 1.2, 0.001);
}

TEST_F(MeasureDepthTest, EndsEarlyAndKeepsWhatIsDone) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  Store(views);
  std::vector<int> done;
  const auto two_of_four = [&done](int number, int count) {
    EXPECT_EQ(count, 4);
    done.push_back(number);
    return number < 2;
  };
  EXPECT_EQ(MeasureDepth(views, {}, {}, store_, images_, &completer_, 2, two_of_four), 2);
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2}));
  EXPECT_LT(MedianError(views[1]), 0.05);
  EXPECT_NEAR(store_.Get(20).range.at<float>(60, 100), 1.2, 0.001);
}

TEST_F(MeasureDepthTest, WhatTheNetworkIsNotSureOfDoesNotPutTheSourcesFartherAway) {
  // Four of five pixels claim 100 times the range, with little confidence, as those of a sky do.
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  Store(views);
  for (const DenseView& view : views) {
    DenseDepth depth = store_.Get(view.frame_index);
    depth.range.rowRange(0, 100) = 120;
    depth.confidence.rowRange(0, 100) = 0.5;
    store_.PutRanges(view.frame_index, depth.range, depth.confidence);
  }
  EXPECT_EQ(MeasureDepth(views, {}, {}, store_, images_, &completer_, 2), 4);
}

TEST_F(MeasureDepthTest, CompletedPixelsAreTrustedLessThanTheNetworkTrustsThem) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  for (const double factor : {1.0, 3.0}) {
    Store(views);
    MeasureDepth(views, {}, {.completion_error_factor = factor}, store_, images_, &completer_, 2);
    // The network of this test is sure of 0.9 at most, and states it where nothing was seen.
    const DenseDepth depth = store_.Get(10);
    const cv::Mat is_stated = cv::abs(depth.confidence - 1 / (1 + factor * (1 / 0.9 - 1))) < 0.003;
    EXPECT_GT(cv::countNonZero(is_stated), 100) << factor;
  }
}

}  // namespace
}  // namespace orb360
