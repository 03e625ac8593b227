#include "slam/pipeline/view_depth.h"

#include <cmath>
#include <optional>
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

TEST(ChooseStereoSources, TakesTheNearestToEachBaselineOnBothSides) {
  const std::vector<DenseView> views = ViewsAt({-5, -1.4, -0.5, -0.02, 0, 0.02, 0.5, 1.4, 5});
  const ViewDepthOptions options{.baselines = {0.1, 0.3}, .max_baseline_ratio = 2.0};
  EXPECT_EQ(ChooseStereoSources(views, 4, views[4].neighbours, 5.0, options),
            (std::vector<size_t>{2, 6, 1, 7}));
  EXPECT_EQ(ChooseStereoSources(views, 0, views[0].neighbours, 5.0, options),
            std::vector<size_t>{});
}

TEST(ChooseStereoSources, AtTheEndOfAPathOneSideGivesAll) {
  std::vector<DenseView> views = ViewsAt({0, 0.4, 0.5, 0.6, 0.9, 1.5, 2.7});
  const ViewDepthOptions options{.baselines = {0.1, 0.3}, .max_baseline_ratio = 2.0};
  EXPECT_EQ(ChooseStereoSources(views, 0, views[0].neighbours, 5.0, options),
            (std::vector<size_t>{2, 5, 4, 6}));
  views[0].neighbours = {2, 5, 6};
  EXPECT_EQ(ChooseStereoSources(views, 0, views[0].neighbours, 5.0, options),
            (std::vector<size_t>{2, 5, 6}));
}

TEST(ChooseStereoSources, TakesNoViewFromTheSamePlaceNorOneThatSeesNothingOfIt) {
  std::vector<DenseView> views = ViewsAt({0, 0, 0.5, 0.6});
  views[0].neighbours = {1, 3};
  EXPECT_EQ(ChooseStereoSources(views, 0, views[0].neighbours, 5.0, {.baselines = {0.1, 0.12}}),
            std::vector<size_t>{3});
}

class ComputeDepthTest : public testing::Test {
 protected:
  ComputeDepthTest()
      : store_(folder_ / "depth"),
        first_(folder_ / "first"),
        images_(folder_ / "depth" / "images"),
        completer_(WritePropagation(folder_),
                   {.size = {kCamera.width(), kCamera.height()}, .threads = 1}) {}

  ViewDepthReport Compute(const std::vector<DenseView>& views,
                          const ViewDepthOptions& options = kAll,
                          const ViewDepthCallbacks& callbacks = {},
                          const std::optional<Eigen::Vector3d>& up = {}) {
    for (const DenseView& view : views) Show(view.frame_index, view.world_from_camera);
    return ComputeDepth(
        views, [&views](size_t view) { return views[view].neighbours; },
        [this](const DenseView&) { return landmarks_; }, up, options, images_, &completer_, 2,
        first_, store_, callbacks);
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
      const int row = i / 128;
      landmarks.push_back({i, {0.5 + 2 * (i % 128), 0.5 + 2 * row}, 2.4, 1.0});
    }
    return landmarks;
  }

  static inline const ViewDepthOptions kAll{.spacing = 0};
  static inline const EquirectangularCamera kCamera{256, 128};
  static inline const BoxRoom kRoom{{4.0, 3.0, 2.0}, 3};
  TempFolder folder_;
  DepthMapStore store_;
  DepthMapStore first_;
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

TEST_F(ComputeDepthTest, MeasuresMoreOfLevelGroundAtAKnownHeightWhereSourcesAreFar) {
  const std::vector<DenseView> views = ViewsAt({0, 2.7, -2.7, 3.1});
  ViewDepthOptions options{.spacing = 0, .baselines = {0.9, 1.0}, .keeps_completed = false};
  // Pixels of the floor of the first view with the right range.
  const auto num_right = [&](double camera_height) {
    options.camera_height = camera_height;
    Compute(views, options, {}, Eigen::Vector3d::UnitZ());
    const cv::Mat range = store_.Get(0).range;
    int count = 0;
    for (int row = range.rows / 2; row < range.rows; ++row) {
      for (int column = 0; column < range.cols; ++column) {
        const Eigen::Vector3d ray =
            views[0].world_from_camera.rotation * kCamera.Bearing({column + 0.5, row + 0.5});
        const double truth = kRoom.Range(Eigen::Vector3d::Zero(), ray);
        const bool is_floor = std::abs(truth * ray.z() + 2.0) < 1e-6;
        count += is_floor && std::abs(range.at<float>(row, column) / truth - 1) < 0.05;
      }
    }
    return count;
  };
  const int unknown = num_right(0);
  const int known = num_right(2.0);
  EXPECT_GT(known, 1.3 * unknown);
}

TEST_F(ComputeDepthTest, ShowsWhatItStoresOfEachView) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  std::vector<int> shown;
  std::vector<DenseDepth> depths;
  ViewDepthCallbacks callbacks;
  callbacks.watcher = [&](int frame_index, const Rigid3& pose, const DenseDepth& depth) {
    EXPECT_EQ(pose.translation, views[shown.size()].world_from_camera.translation);
    shown.push_back(frame_index);
    depths.push_back(depth);
  };
  Compute(views, kAll, callbacks);
  ASSERT_EQ(shown, (std::vector<int>{0, 10, 20, 30}));
  for (size_t i = 0; i < shown.size(); ++i) {
    EXPECT_EQ(depths[i].color.size(), depths[i].range.size());
    const cv::Mat stored = store_.Get(shown[i]).range;  // 0 where the confidence is
    const cv::Mat is_wrong = cv::abs(stored - depths[i].range) > 0.01 * depths[i].range;
    EXPECT_EQ(cv::countNonZero(is_wrong & (stored > 0)), 0);
    EXPECT_EQ(cv::countNonZero((depths[i].confidence > 0) & (stored == 0)), 0);
    EXPECT_GT(cv::countNonZero(stored), 10000);
  }
}

TEST_F(ComputeDepthTest, WithoutTwoSourcesTheNetworkCompletesTheLandmarks) {
  EXPECT_EQ(Compute(ViewsAt({0, 0.3})).without_sources, 2);
  EXPECT_NEAR(store_.Get(0).range.at<float>(60, 100), 2.4, 0.01);
}

TEST_F(ComputeDepthTest, AViewWithFewLandmarksAndWithoutStereoGetsNoDepth) {
  landmarks_.resize(49);
  EXPECT_EQ(Compute(ViewsAt({0, 0.3})).measured, 0);
  EXPECT_FALSE(store_.Contains(0));
  EXPECT_EQ(Compute(ViewsAt({-0.5, 0, 0.5, 1.0})).measured, 4);
  EXPECT_TRUE(store_.Contains(0));
}

TEST_F(ComputeDepthTest, ReferenceViewsKeepTheirDistanceAndTheOthersAreSources) {
  // The room is about 3 m away on the median, its landmarks here 2.4 m.
  const std::vector<DenseView> views = ViewsAt({0, 0.3, 0.6, 0.9, 1.2, 1.5});
  EXPECT_EQ(Compute(views, {.spacing = 0.15, .min_views = 1}).measured, 3);
  for (size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(store_.Contains(views[i].frame_index), i % 2 == 0) << i;
  }
  EXPECT_LT(MedianError(views[2]), 0.05);
}

TEST_F(ComputeDepthTest, AShortPathHasEnoughReferenceViewsToo) {
  Compute(ViewsAt({0, 0.11, 0.2, 0.31, 0.44}), {.spacing = 1.0, .min_views = 3});
  for (int i = 0; i < 5; ++i) EXPECT_EQ(store_.Contains(10 * i), i % 2 == 0) << i;
}

TEST_F(ComputeDepthTest, TheSinkReceivesRangesByStereoAmongThePointsOrLandmarksAlone) {
  for (const bool has_sources : {true, false}) {
    const std::vector<DenseView> views =
        ViewsAt(has_sources ? std::vector{-0.5, 0.0, 0.5, 1.0} : std::vector{0.0, 0.3});
    std::vector<SparseSample> samples;
    Compute(views, kAll, {.sink = [&](const SparseSample& s) { samples.push_back(s); }});
    ASSERT_EQ(samples.size(), views.size());
    for (const SparseSample& sample : samples) {
      EXPECT_TRUE(store_.Contains(sample.frame_index));
      EXPECT_EQ(sample.image.size(), sample.sparse.range.size());
      const cv::Mat is_point = sample.sparse.range > 0;
      const cv::Mat is_landmark = cv::abs(sample.sparse.range - 2.4) < 1e-5;
      const int num_other = cv::countNonZero(is_point & ~is_landmark);
      EXPECT_EQ(num_other > 300, has_sources) << num_other;
    }
  }
}

TEST_F(ComputeDepthTest, WithoutAnyLandmarkFewViewsAreTriedToo) {
  landmarks_.clear();
  const std::vector<DenseView> views = ViewsAt({0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
  EXPECT_EQ(Compute(views, {.min_views = 2}).without_sources, 2);
}

TEST_F(ComputeDepthTest, WhereNothingTellsDepthViewsAreNotTriedOneByOne) {
  const std::vector<DenseView> views = ViewsAt({0, 0.3, 0.6, 0.9, 1.2, 1.5});
  landmarks_.resize(49);
  // With no texture asked for, each view that is tried is counted.
  const ViewDepthReport report =
      Compute(views, {.spacing = 0.15, .min_views = 1, .min_fraction = 1.1});
  EXPECT_EQ(report.unseen + report.without_sources, 3);
  EXPECT_FALSE(store_.Contains(0));
}

TEST_F(ComputeDepthTest, ACameraThatTurnsOnTheSpotHasOneReferenceViewInEachMap) {
  std::vector<DenseView> views = ViewsAt({0, 0, 0, 0});
  views[2].map = 1;
  views[3].map = 1;
  EXPECT_EQ(Compute(views, {}).without_sources, 2);
  EXPECT_TRUE(store_.Contains(0));
  EXPECT_FALSE(store_.Contains(10));
  EXPECT_TRUE(store_.Contains(20));
}

TEST_F(ComputeDepthTest, WhereStereoSeesLittleItCountsForNothing) {
  EXPECT_EQ(Compute(ViewsAt({-0.5, 0, 0.5, 1.0}), {.spacing = 0, .min_fraction = 0.999}).unseen, 4);
  EXPECT_NEAR(store_.Get(0).range.at<float>(60, 100), 2.4, 0.01);
}

TEST_F(ComputeDepthTest, AnInterruptLeavesTheRestToTheNetwork) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  std::vector<int> done;
  const auto two_of_four = [&done](int number, int count) {
    EXPECT_EQ(count, 8);  // of both passes
    done.push_back(number);
    return number < 2;
  };
  EXPECT_EQ(Compute(views, kAll, {.progress = two_of_four}).measured, 2);
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_LT(MedianError(views[1]), 0.05);
  EXPECT_NEAR(store_.Get(20).range.at<float>(60, 100), 2.4, 0.01);
}

TEST_F(ComputeDepthTest, WithoutCompletionItHasWhatStereoMeasures) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  Compute(views);
  const DenseDepth both = store_.Get(10);
  EXPECT_EQ(Compute(views, {.spacing = 0, .keeps_completed = false}).measured, 4);
  const DenseDepth measured = store_.Get(10);
  const cv::Mat is_measured = measured.range > 0;
  EXPECT_GT(cv::countNonZero(is_measured), 0.5 * static_cast<double>(is_measured.total()));
  EXPECT_LT(cv::countNonZero(is_measured), cv::countNonZero(both.range > 0));
  EXPECT_EQ(cv::norm(measured.range, both.range, cv::NORM_INF, is_measured), 0);
}

TEST_F(ComputeDepthTest, ErrorsOfCompletedPixelsAreThoseOfTheNetworkTimesTheFactor) {
  const std::vector<DenseView> views = ViewsAt({-0.5, 0, 0.5, 1.0});
  for (const double factor : {1.0, 3.0}) {
    Compute(views, {.spacing = 0, .completed_error_factor = factor});
    // The network of this test is sure of 0.9 at most, and states it where nothing was seen.
    const DenseDepth depth = store_.Get(10);
    const cv::Mat is_stated = cv::abs(depth.confidence - 1 / (1 + factor * (1 / 0.9 - 1))) < 0.003;
    EXPECT_GT(cv::countNonZero(is_stated), 100) << factor;
  }
}

}  // namespace
}  // namespace orb360
