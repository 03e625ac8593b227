#include "slam/pipeline/keyframe_completion.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/propagation_network.h"

namespace orb360 {
namespace {

constexpr double kHeight = 4;  // of the camera over a level ground
constexpr int kFrame = 30;

class KeyframeCompletionTest : public testing::Test {
 protected:
  KeyframeCompletionTest() {
    options_.adoption_frames = 5;
    // One feature without a landmark, looking down and ahead.
    auto features = std::make_shared<Features>();
    features->bearings.push_back(Eigen::Vector3d(-1, 0, -1).normalized());
    features->keypoints.push_back(
        {completer_.camera().Project(features->bearings[0]).cast<float>(), 0, 0.001F, 0, 50});
    keyframe_.frame_index = kFrame;
    keyframe_.features = features;
    keyframe_.landmarks = {kNoId};
  }

  /// The ground at every pixel below the horizon, and a wall around at ten heights.
  std::vector<SparsePoint> Points() const {
    const EquirectangularCamera& camera = completer_.camera();
    std::vector<SparsePoint> points;
    for (int y = 0; y < camera.height(); ++y) {
      for (int x = 0; x < camera.width(); ++x) {
        const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
        const double down = -camera.Bearing(pixel).z();
        const double range = std::min(10 * kHeight, kHeight / std::max(down, 1e-3));
        points.push_back({static_cast<LandmarkId>(points.size()), pixel, range, 1.0});
      }
    }
    return points;
  }
  cv::Mat Image() const { return {64, 128, CV_8UC3, cv::Scalar::all(90)}; }
  KeyframeCompletion Make() { return {&completer_, options_}; }

  TempFolder folder_;
  DepthCompleter completer_{WritePropagation(folder_), {.size = {128, 64}}};
  DepthOptions options_;
  Keyframe keyframe_;
};

TEST_F(KeyframeCompletionTest, TellsTheRangesOfFeaturesAndTheGroundWhenDue) {
  KeyframeCompletion depth = Make();
  EXPECT_FALSE(depth.pending().has_value());
  depth.Start(keyframe_, Image(), Points(), 100);
  EXPECT_EQ(depth.pending(), kFrame);
  EXPECT_FALSE(depth.IsDue(104));
  EXPECT_TRUE(depth.IsDue(105));
  const CompletedKeyframe completed = depth.Take(1.0);
  EXPECT_FALSE(depth.pending().has_value());
  EXPECT_FALSE(depth.IsRunning());
  EXPECT_EQ(completed.frame_index, kFrame);
  ASSERT_EQ(completed.priors.size(), 1u);
  EXPECT_NEAR(completed.priors[0].range, kHeight * std::sqrt(2.0), 0.1);
  EXPECT_GT(completed.priors[0].sigma, 0);
  ASSERT_TRUE(completed.ground.has_value());
  EXPECT_NEAR(completed.ground->log_height, std::log(kHeight), 0.02);
  EXPECT_GT(completed.ground->up.z(), 0.999);
}

TEST_F(KeyframeCompletionTest, FollowsChangesOfTheUnit) {
  KeyframeCompletion depth = Make();
  depth.Start(keyframe_, Image(), Points(), 0);
  const CompletedKeyframe completed = depth.Take(0.5);
  EXPECT_NEAR(completed.priors[0].range, 0.5 * kHeight * std::sqrt(2.0), 0.05);
  EXPECT_NEAR(completed.ground->log_height, std::log(0.5 * kHeight), 0.02);
}

TEST_F(KeyframeCompletionTest, LeavesOutAKeyframeWithTooFewPoints) {
  KeyframeCompletion depth = Make();
  std::vector<SparsePoint> points = Points();
  points.resize(static_cast<size_t>(options_.min_points) - 1);
  depth.Start(keyframe_, Image(), points, 0);
  EXPECT_FALSE(depth.pending().has_value());
}

}  // namespace
}  // namespace orb360
