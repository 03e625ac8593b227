#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "nn/base/statistics.h"
#include "slam/io/depth_map_store.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/pipeline/hall_walk.h"
#include "tests/slam/pipeline/propagation_network.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {
namespace {

// Not a == b: 0 and -0 differ.
template <int kSize>
bool SameBytes(const Eigen::Matrix<double, kSize, 1>& a, const Eigen::Matrix<double, kSize, 1>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<uint64_t, double>,
                            std::bit_cast<uint64_t, double>);
}

bool SameBytes(const Rigid3& a, const Rigid3& b) {
  return SameBytes(a.rotation.coeffs(), b.rotation.coeffs()) &&
         SameBytes(a.translation, b.translation);
}

void ExpectSame(const Reconstruction& a, const Reconstruction& b) {
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (size_t i = 0; i < a.frames.size(); ++i) {
    ASSERT_EQ(a.frames[i].index, b.frames[i].index);
    ASSERT_TRUE(SameBytes(a.frames[i].world_from_camera, b.frames[i].world_from_camera)) << i;
  }
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (size_t i = 0; i < a.keyframes.size(); ++i) {
    ASSERT_EQ(a.keyframes[i].index, b.keyframes[i].index);
    ASSERT_TRUE(SameBytes(a.keyframes[i].world_from_camera, b.keyframes[i].world_from_camera));
  }
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (size_t i = 0; i < a.landmarks.size(); ++i) {
    ASSERT_TRUE(SameBytes(a.landmarks[i].position, b.landmarks[i].position));
    ASSERT_EQ(a.landmarks[i].color, b.landmarks[i].color);
  }
}

TEST(SystemSlow, TracksAWholeWalkWithinHalfAPercent) {
  const std::vector<double> frames = Count(150);
  const Reconstruction result = Track(Hall(), frames);
  ASSERT_EQ(result.frames.size(), 150u);  // those before the initialization too
  EXPECT_EQ(result.lost, 0);
  EXPECT_EQ(result.maps.size(), 1u);
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.005 * error.length);
  EXPECT_LT(error.worst_rotation, 0.02);
  EXPECT_TRUE(result.maps.front().is_metric);
  EXPECT_NEAR(error.scale, 1.0, 0.02);
  // Keyframes are frames: both lists say the same of them.
  ASSERT_GT(result.keyframes.size(), 5u);
  for (const FramePose& keyframe : result.keyframes) {
    const Rigid3& frame = result.frames[keyframe.index].world_from_camera;
    EXPECT_EQ(frame.translation, keyframe.world_from_camera.translation) << keyframe.index;
  }
  // After the last one nothing would hold the frames.
  EXPECT_EQ(result.keyframes.back().index, 149);
}

TEST(SystemSlow, PositionsGiveMetresWhereNoGroundDoes) {
  const BoxRoom room = Hall();
  Options options = SmallOptions();
  options.scale.from_ground = false;
  System system(kHallCamera, options, {});
  std::vector<PositionFix> fixes;
  for (int i = 0; i < 100; ++i) {
    system.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(i))));
    fixes.push_back({i / 25.0, TruePose(i).translation, 0.01, 0.01});
  }
  std::vector<PositionFix> wrong = fixes;
  wrong[7].sigma = -1;
  EXPECT_THROW(system.Finish({wrong}), ContractError) << "and nothing is lost";
  const Reconstruction result = system.Finish({fixes});
  EXPECT_EQ(result.scale.state, ScaleState::kMetric);
  EXPECT_EQ(result.scale.sources, std::vector<std::string>{"positions"});
  EXPECT_NEAR(result.scale.value, 1.0, 1e-6);
  EXPECT_TRUE(result.maps.front().is_metric);
  EXPECT_NEAR(Compare(result.frames, Count(100)).scale, 1.0, 0.01);
}

TEST(SystemSlow, GivesTheSameBytesForAnyNumberOfThreadsAndEveryTime) {
  const BoxRoom room = Hall();
  const std::vector<double> frames = Count(60);
  const Reconstruction two = Track(room, frames, 2);
  const Reconstruction one = Track(room, frames, 1);
  const Reconstruction three = Track(room, frames, 3);
  ASSERT_GT(two.frames.size(), 50u);
  ExpectSame(two, one);
  ExpectSame(two, three);
  ExpectSame(two, Track(room, frames));
}

struct Completed {
  Reconstruction result;
  std::vector<std::pair<int, DenseDepth>> depths;  // by frame index, in the order they came
  std::vector<Map> maps;
};

Completed TrackAndComplete(const BoxRoom& room, const std::vector<double>& frames,
                           int num_threads = 2, bool guides_mapping = false) {
  const TempFolder folder;
  Options options = SmallOptions();
  options.depth.guides_mapping = guides_mapping;
  options.depth.height = 128;
  options.depth.view_spacing = 0.05;
  options.num_threads = num_threads;
  System system(kHallCamera, options, {});
  Completed completed;
  system.EnableDepth(WritePropagation(folder), folder / "depth");
  for (size_t i = 0; i < frames.size(); ++i) {
    system.Process(MakeFrame(static_cast<int>(i), room.Render(kHallCamera, TruePose(frames[i]))));
  }
  completed.result = system.Finish();
  system.ComputeDepth(completed.result);
  for (const FramePose& frame : completed.result.frames) {
    if (!system.depth_maps()->Contains(frame.index)) continue;
    completed.depths.emplace_back(frame.index, system.depth_maps()->Get(frame.index));
  }
  completed.maps.assign(system.maps().begin(), system.maps().end());
  return completed;
}

TEST(SystemSlow, ComputesTheDepthOfViewsInMetresAndChangesNoPose) {
  const BoxRoom room = Hall();
  const std::vector<double> frames = Count(60);
  const auto [result, depths, maps] = TrackAndComplete(room, frames);
  ExpectSame(result, Track(room, frames));  // Depth changes no pose unless it guides mapping.
  ASSERT_GE(depths.size(), 5u);
  EXPECT_LT(depths.size(), 40u);  // of 60 frames
  const EquirectangularCamera camera(256, 128);
  for (const auto& [frame_index, depth] : depths) {
    const Rigid3 pose = TruePose(frame_index);
    std::vector<double> errors;
    for (int y = 0; y < depth.range.rows; ++y) {
      for (int x = 0; x < depth.range.cols; ++x) {
        if (!(depth.confidence.at<float>(y, x) > 0)) continue;  // no point near
        const double truth =
            room.Range(pose.translation, pose.rotation * camera.Bearing({x + 0.5, y + 0.5}));
        errors.push_back(std::abs(std::log(depth.range.at<float>(y, x) / truth)));
      }
    }
    ASSERT_GT(errors.size(), 500u);
    EXPECT_LT(Median(errors), 0.05) << frame_index;
  }
}

TEST(SystemSlow, KeyframesKnowTheRangesOfFeaturesWithoutALandmark) {
  const BoxRoom room = Hall();
  const Completed completed = TrackAndComplete(room, Count(60), 2, /*guides_mapping=*/true);
  ASSERT_EQ(completed.maps.size(), 1u);
  const Map& map = completed.maps.front();
  std::vector<double> errors;
  for (const KeyframeId id : map.KeyframeIds()) {
    const Keyframe& keyframe = map.keyframe(id);
    const Rigid3 pose = TruePose(keyframe.frame_index);
    for (int f = 0; f < keyframe.features->size(); ++f) {
      const RangePrior prior = keyframe.PriorOf(f);
      if (prior.sigma == 0) continue;
      const double truth =
          room.Range(pose.translation, pose.rotation * keyframe.features->bearings[f]);
      // In metres like the map, though some were made before it was.
      errors.push_back(std::abs(std::log(prior.range / truth)));
    }
  }
  ASSERT_GT(errors.size(), 100u);
  EXPECT_LT(Median(errors), 0.1);
}

TEST(SystemSlow, CompletesTheSameForAnyNumberOfThreads) {
  const BoxRoom room = Hall();
  const std::vector<double> frames = Count(40);
  const Completed two = TrackAndComplete(room, frames, 2);
  const Completed one = TrackAndComplete(room, frames, 1);
  ASSERT_EQ(two.depths.size(), one.depths.size());
  for (size_t i = 0; i < two.depths.size(); ++i) {
    EXPECT_EQ(two.depths[i].first, one.depths[i].first);
    EXPECT_EQ(cv::norm(two.depths[i].second.range, one.depths[i].second.range, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(two.depths[i].second.color, one.depths[i].second.color, cv::NORM_INF), 0);
  }
  ExpectSame(two.result, one.result);
}

TEST(SystemSlow, KeyframesAreCloseToEachOtherWhileTheGroundIsSought) {
  // A stroll, which needs a keyframe every second.
  const auto largest_gap = [](bool from_ground) {
    Options options = SmallOptions();
    options.scale.from_ground = from_ground;
    options.loop.enabled = false;
    options.keyframe.mapping_frames = 10;
    System system(kHallCamera, options, {});
    std::vector<double> times;  // at which a keyframe was added
    int count = 0;
    for (int i = 0; i < 50; ++i) {
      const Frame frame = MakeFrame(i, Hall().Render(kHallCamera, TruePose(0.25 * i)));
      const FrameReport report = system.Process(frame);
      if (report.num_keyframes > count) times.push_back(frame.timestamp);
      count = report.num_keyframes;
    }
    system.Finish();
    double gap = 0;
    for (size_t i = 1; i < std::min<size_t>(times.size(), 7); ++i) {
      gap = std::max(gap, times[i] - times[i - 1]);
    }
    return gap;
  };
  EXPECT_GT(largest_gap(false), 0.6);
  EXPECT_LT(largest_gap(true), 0.32);  // 0.25, and a frame that mapping takes
}

TEST(SystemSlow, TracksAtSixFramesASecond) {
  std::vector<double> frames;
  for (int i = 0; i < 40; ++i) frames.push_back(4.0 * i);
  const Reconstruction result = Track(Hall(), frames);
  EXPECT_GE(result.frames.size(), 38u);
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.005 * error.length);
}

// 0.8 m from frame to frame, walls and floor 2 to 4 m away.
TEST(SystemSlow, TracksLargeStepsBetweenFrames) {
  std::vector<double> frames;
  for (int i = 0; i < 16; ++i) frames.push_back(16.0 * i);
  const Reconstruction result = Track(Hall(), frames);
  EXPECT_EQ(result.frames.size(), frames.size());
  EXPECT_EQ(result.lost, 0);
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.005 * error.length);
}

TEST(SystemSlow, WaitsForMotionAndThenTracksTheBeginningBackwards) {
  std::vector<double> frames(15, 0.0);  // the camera stands still at first
  for (int i = 0; i < 60; ++i) frames.push_back(i);
  const Reconstruction result = Track(Hall(), frames);
  ASSERT_TRUE(result.initialized_at.has_value());
  EXPECT_GT(*result.initialized_at, 15);
  EXPECT_EQ(result.frames.size(), frames.size());
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.01 * error.length);
}

TEST(SystemSlow, KnowsHowTheCameraTurnedLongBeforeItMoved) {
  constexpr int kStanding = 25;
  const BoxRoom room = Hall();
  std::vector<Rigid3> truth;
  for (int i = 0; i < kStanding; ++i) {
    Rigid3 pose = TruePose(0);
    pose.rotation = pose.rotation * ExpSo3({0.0, 0.0, 0.3 * std::sin(2 * M_PI * i / kStanding)});
    truth.push_back(pose);
  }
  for (int i = 0; i < 50; ++i) truth.push_back(TruePose(i));
  Options options = SmallOptions();
  options.recovery.max_pending_frames = 5;
  System system(kHallCamera, options, {});
  for (size_t i = 0; i < truth.size(); ++i) {
    system.Process(MakeFrame(static_cast<int>(i), room.Render(kHallCamera, truth[i])));
  }
  const Reconstruction result = system.Finish();
  ASSERT_EQ(result.frames.size(), truth.size());
  const Rigid3& last = result.frames.back().world_from_camera;
  for (int i = 0; i < kStanding; ++i) {
    const Rigid3 found = last.Inverse() * result.frames[i].world_from_camera;
    const Rigid3 expected = truth.back().Inverse() * truth[i];
    EXPECT_LT(found.rotation.angularDistance(expected.rotation), 0.01) << i;
    EXPECT_LT((found.translation - expected.translation).norm(), 0.1) << i;  // m
  }
}

TEST(System, GivesNothingButDoesNotFailOnAWorldWithoutTexture) {
  System system(kHallCamera, SmallOptions(), {});
  for (int i = 0; i < 5; ++i) {
    const FrameReport report =
        system.Process(MakeFrame(i, cv::Mat(320, 640, CV_8UC3, cv::Scalar::all(128))));
    EXPECT_EQ(report.state, TrackingState::kInitializing);
    EXPECT_FALSE(report.world_from_camera.has_value());
  }
  const Reconstruction result = system.Finish();
  EXPECT_TRUE(result.frames.empty());
  EXPECT_FALSE(result.initialized_at.has_value());
}

TEST(System, RefusesAnImageOfAnotherSize) {
  System system(kHallCamera, SmallOptions(), {});
  EXPECT_THROW(system.Process(MakeFrame(0, cv::Mat(100, 200, CV_8UC3))), ContractError);
}

}  // namespace
}  // namespace orb360
