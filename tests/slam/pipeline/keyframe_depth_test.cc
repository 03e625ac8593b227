#include "slam/pipeline/keyframe_depth.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

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
  const KeyframeDepthOptions options{.baselines = {0.1, 0.3}, .max_baseline_ratio = 2.0};
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

class ComputeDepthTest : public testing::Test {
 protected:
  ComputeDepthTest()
      : store_(folder_ / "depth"),
        images_(folder_ / "depth" / "images"),
        completer_(WritePropagation(folder_),
                   {.size = {kCamera.width(), kCamera.height()}, .threads = 1}) {}

  KeyframeDepthReport Compute(const std::vector<DenseView>& views,
                              const KeyframeDepthOptions& options = {},
                              const std::vector<FramePose>& frames = {},
                              const KeyframeProgress& progress = nullptr) {
    for (const DenseView& view : views) Show(view.frame_index, view.world_from_camera);
    return ComputeDepth(
        views, frames, [this](const DenseView&) { return landmarks_; }, options, images_,
        &completer_, 2, store_, progress);
  }

  // Stores an image of the room.
  void Show(int frame_index, const Rigid3& pose) const {
    images_.Put(frame_index, kRoom.Render(kCamera, pose));
  }

  // Median of |ln| of the ratio of a view's ranges to the truth.
  double MedianError(const DenseView& view) const {
    const cv::Mat range = store_.Get(view.frame_index).range;
    std::vector<double> errors;
    for (int row = 30; row < range.rows - 30; row += 3) {
      for (int column = 0; column < range.cols; column += 3) {
        const Eigen::Vector3d ray =
            view.world_from_camera.rotation * kCamera.Bearing({column + 0.5, row + 0.5});
        const double truth = kRoom.Range(view.world_from_camera.translation, ray);
        errors.push_back(std::abs(std::log(range.at<float>(row, column) / truth)));
      }
    }
    return Median(errors);
  }

  // Landmarks at every second pixel, all at one wrong range.
  static std::vector<SparsePoint> WrongLandmarks() {
    std::vector<SparsePoint> landmarks;
    for (int i = 0; i < 64 * 128; ++i) {
      landmarks.push_back({i, {0.5 + 2 * (i % 128), 0.5 + 2 * (i / 128)}, 2.4, 1.0});
    }
    return landmarks;
  }

  static inline const EquirectangularCamera kCamera{256, 128};
  static inline const BoxRoom kRoom{{4.0, 3.0, 2.0}, 3};
  TempFolder folder_;
  DepthMapStore store_;
  ImageStore images_;
  DepthCompleter completer_;
  std::vector<SparsePoint> landmarks_ = WrongLandmarks();
};

TEST_F(ComputeDepthTest, RangesAreMeasuredByStereo) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  EXPECT_EQ(Compute(views).measured, 4);
  for (const DenseView& view : views) EXPECT_LT(MedianError(view), 0.05) << view.frame_index;
  EXPECT_EQ(store_.Get(0).color.size(), cv::Size(256, 128));
}

TEST_F(ComputeDepthTest, WithoutTwoSourcesTheNetworkCompletesTheLandmarks) {
  EXPECT_EQ(Compute(ViewsAt({0, 0.3})).without_sources, 2);
  EXPECT_NEAR(store_.Get(0).range.at<float>(60, 100), 2.4, 0.01);
}

TEST_F(ComputeDepthTest, AKeyframeWithFewLandmarksAndWithoutStereoGetsNoDepth) {
  landmarks_.resize(49);
  EXPECT_EQ(Compute(ViewsAt({0, 0.3})).measured, 0);
  EXPECT_FALSE(store_.Contains(0));
  EXPECT_EQ(Compute(ViewsAt({-0.5, 0, 0.5, 1.0})).measured, 4);
  EXPECT_TRUE(store_.Contains(0));
}

TEST_F(ComputeDepthTest, FramesThatAreNoKeyframesAreSources) {
  const std::vector<DenseView> views = ViewsAt({0, 0.6});
  const FramePose between = FrameAt(5, 0.3);
  Show(between.index, between.world_from_camera);
  EXPECT_EQ(Compute(views, {}, {between}).measured, 2);
  for (const DenseView& view : views) EXPECT_LT(MedianError(view), 0.05) << view.frame_index;
}

TEST_F(ComputeDepthTest, WhereStereoSeesLittleItCountsForNothing) {
  EXPECT_EQ(Compute(ViewsAt({-0.5, 0, 0.5, 1.0}), {.min_fraction = 0.999}).unseen, 4);
  EXPECT_NEAR(store_.Get(0).range.at<float>(60, 100), 2.4, 0.01);
}

TEST_F(ComputeDepthTest, AnInterruptLeavesTheRestToTheNetwork) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  std::vector<int> done;
  const auto two_of_four = [&done](int number, int count) {
    EXPECT_EQ(count, 4);
    done.push_back(number);
    return number < 2;
  };
  EXPECT_EQ(Compute(views, {}, {}, two_of_four).measured, 2);
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_LT(MedianError(views[1]), 0.05);
  EXPECT_NEAR(store_.Get(20).range.at<float>(60, 100), 2.4, 0.01);
}

TEST_F(ComputeDepthTest, WithoutCompletionItHasWhatStereoMeasures) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  Compute(views);
  const DenseDepth both = store_.Get(10);
  EXPECT_EQ(Compute(views, {.keeps_completed = false}).measured, 4);
  const DenseDepth measured = store_.Get(10);
  const cv::Mat is_measured = measured.range > 0;
  EXPECT_GT(cv::countNonZero(is_measured), 0.5 * static_cast<double>(is_measured.total()));
  EXPECT_LT(cv::countNonZero(is_measured), cv::countNonZero(both.range > 0));
  EXPECT_EQ(cv::norm(measured.range, both.range, cv::NORM_INF, is_measured), 0);
}

TEST_F(ComputeDepthTest, CompletedPixelsAreTrustedLessThanTheNetworkTrustsThem) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  for (const double factor : {1.0, 3.0}) {
    Compute(views, {.completion_error_factor = factor});
    // The network of this test is sure of 0.9 at most, and states it where nothing was seen.
    const DenseDepth depth = store_.Get(10);
    const cv::Mat is_stated = cv::abs(depth.confidence - 1 / (1 + factor * (1 / 0.9 - 1))) < 0.003;
    EXPECT_GT(cv::countNonZero(is_stated), 100) << factor;
  }
}

}  // namespace
}  // namespace orb360
