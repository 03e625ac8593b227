#include "slam/pipeline/system.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <omp.h>

#include "nn/base/check.h"
#include "slam/geometry/alignment.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/pipeline/box_room.h"
#include "tests/slam/pipeline/propagation_network.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(640, 320);

// A walk through a hall on a curve, the camera swaying: 25 frames a second, about 1.3 m/s.
Rigid3 TruePose(double frame) {
  const double t = frame / 25.0;
  const Eigen::Vector3d position(6.0 - 1.3 * t, 1.2 * std::sin(0.5 * t), 0.05 * std::sin(6.0 * t));
  const Eigen::Quaterniond yaw = ExpSo3(Eigen::Vector3d(0.0, 0.0, -0.4 * std::sin(0.5 * t)));
  return {yaw * ExpSo3({0.03 * std::sin(5.0 * t), 0.04 * std::sin(3.0 * t), 0.0}), position};
}

BoxRoom Hall(uint64_t seed = 1) { return BoxRoom({8.0, 4.0, 2.0}, seed); }

Options SmallOptions() {
  Options options;
  options.orb.num_features = 1000;
  options.scale.camera_height = 2.0;  // of TruePose over the floor of Hall
  return options;
}

Frame MakeFrame(int index, const cv::Mat& image) { return {index, index / 25.0, image}; }

// Feeds `frames` and returns everything; a frame number that is not whole is still its own frame.
Reconstruction Track(const BoxRoom& room, const std::vector<double>& frames) {
  System system(kCamera, SmallOptions(), {});
  for (size_t i = 0; i < frames.size(); ++i) {
    system.Process(MakeFrame(static_cast<int>(i), room.Render(kCamera, TruePose(frames[i]))));
  }
  return system.Finish();
}

std::vector<double> Count(int count) {
  std::vector<double> frames;
  for (int i = 0; i < count; ++i) frames.push_back(i);
  return frames;
}

// Root mean square and length of the path, after the best similarity.
struct PathError {
  double rmse = 0;
  double length = 0;
  double worst_rotation = 0;  // rad
  double scale = 1;           // from the result to the truth
};
PathError Compare(const std::vector<FramePose>& frames, const std::vector<double>& truth) {
  std::vector<Eigen::Vector3d> found;
  std::vector<Eigen::Vector3d> expected;
  PathError error;
  for (const FramePose& frame : frames) {
    found.push_back(frame.world_from_camera.translation);
    expected.push_back(TruePose(truth[frame.index]).translation);
    if (expected.size() > 1) {
      error.length += (expected.back() - expected[expected.size() - 2]).norm();
    }
  }
  const Similarity3 fit = AlignSimilarity(found, expected).value();
  error.scale = fit.scale;
  double sum = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    sum += (fit * found[i] - expected[i]).squaredNorm();
    const Eigen::Quaterniond rotation = fit.rotation * frames[i].world_from_camera.rotation;
    error.worst_rotation = std::max(
        error.worst_rotation, rotation.angularDistance(TruePose(truth[frames[i].index]).rotation));
  }
  error.rmse = std::sqrt(sum / static_cast<double>(found.size()));
  return error;
}

bool SameBytes(const Rigid3& a, const Rigid3& b) {
  return std::memcmp(a.rotation.coeffs().data(), b.rotation.coeffs().data(), 4 * sizeof(double)) ==
             0 &&
         std::memcmp(a.translation.data(), b.translation.data(), 3 * sizeof(double)) == 0;
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
    ASSERT_EQ(std::memcmp(a.landmarks[i].position.data(), b.landmarks[i].position.data(),
                          3 * sizeof(double)),
              0);
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
}

TEST(SystemSlow, GivesTheSameBytesForAnyNumberOfThreadsAndEveryTime) {
  const BoxRoom room = Hall();
  const std::vector<double> frames = Count(60);
  omp_set_num_threads(2);
  const Reconstruction two = Track(room, frames);
  omp_set_num_threads(1);
  const Reconstruction one = Track(room, frames);
  omp_set_num_threads(3);
  const Reconstruction three = Track(room, frames);
  omp_set_num_threads(2);
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

Completed TrackAndComplete(const BoxRoom& room, const std::vector<double>& frames) {
  const TempFolder folder;
  DepthCompleter completer(WritePropagation(folder), {.size = {256, 128}});
  System system(kCamera, SmallOptions(), {});
  Completed completed;
  system.CompleteKeyframes(&completer, [&](int frame_index, DenseDepth depth) {
    completed.depths.emplace_back(frame_index, std::move(depth));
  });
  for (size_t i = 0; i < frames.size(); ++i) {
    system.Process(MakeFrame(static_cast<int>(i), room.Render(kCamera, TruePose(frames[i]))));
  }
  completed.result = system.Finish();
  completed.maps = system.maps();
  return completed;
}

TEST(SystemSlow, CompletesKeyframesInMetresBesideTracking) {
  const BoxRoom room = Hall();
  const std::vector<double> frames = Count(60);
  const auto [result, depths, maps] = TrackAndComplete(room, frames);
  ASSERT_EQ(result.frames.size(), Track(room, frames).frames.size());
  ASSERT_GE(depths.size(), 5u);
  const EquirectangularCamera camera(256, 128);
  for (size_t i = 0; i < depths.size(); ++i) {
    const auto& [frame_index, depth] = depths[i];
    if (i > 0) {
      EXPECT_GT(frame_index, depths[i - 1].first);
    }
    ASSERT_TRUE(result.depth_scales.contains(frame_index));
    const double scale = result.depth_scales.at(frame_index);
    const Rigid3 pose = TruePose(frame_index);
    std::vector<double> errors;
    for (int y = 0; y < depth.range.rows; ++y) {
      for (int x = 0; x < depth.range.cols; ++x) {
        if (!(depth.confidence.at<float>(y, x) > 0)) continue;  // no point near
        const double truth =
            room.Range(pose.translation, pose.rotation * camera.Bearing({x + 0.5, y + 0.5}));
        errors.push_back(std::abs(std::log(scale * depth.range.at<float>(y, x) / truth)));
      }
    }
    ASSERT_GT(errors.size(), 500u);
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.05) << frame_index;
  }
}

TEST(SystemSlow, KeyframesKnowTheRangesOfFeaturesWithoutALandmark) {
  const BoxRoom room = Hall();
  const Completed completed = TrackAndComplete(room, Count(60));
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
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);
}

TEST(SystemSlow, CompletesTheSameForAnyNumberOfThreads) {
  const BoxRoom room = Hall();
  const std::vector<double> frames = Count(40);
  const Completed two = TrackAndComplete(room, frames);
  omp_set_num_threads(1);
  const Completed one = TrackAndComplete(room, frames);
  omp_set_num_threads(2);
  ASSERT_EQ(two.depths.size(), one.depths.size());
  for (size_t i = 0; i < two.depths.size(); ++i) {
    EXPECT_EQ(two.depths[i].first, one.depths[i].first);
    EXPECT_EQ(cv::norm(two.depths[i].second.range, one.depths[i].second.range, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(two.depths[i].second.color, one.depths[i].second.color, cv::NORM_INF), 0);
  }
  ExpectSame(two.result, one.result);
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

TEST(SystemSlow, FindsItselfAgainAfterAShortBlackout) {
  const BoxRoom room = Hall();
  System system(kCamera, SmallOptions(), {});
  std::vector<double> frames;
  for (int i = 0; i < 90; ++i) {
    frames.push_back(i);
    const cv::Mat image = room.Render(kCamera, TruePose(i));
    const bool black = i >= 50 && i < 60;
    system.Process(MakeFrame(i, black ? cv::Mat(cv::Mat::zeros(image.size(), CV_8UC3)) : image));
  }
  const Reconstruction result = system.Finish();
  EXPECT_EQ(result.lost, 1);
  EXPECT_EQ(result.maps.size(), 1u);
  EXPECT_GE(result.frames.size(), 79u);
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.01 * error.length);
}

TEST(SystemSlow, BeginsANewMapElsewhereAndKeepsTheOldOne) {
  const BoxRoom first = Hall(1);
  const BoxRoom second = Hall(99);
  System system(kCamera, SmallOptions(), {});
  for (int i = 0; i < 130; ++i) {
    const BoxRoom& room = i < 60 ? first : second;
    system.Process(MakeFrame(i, room.Render(kCamera, TruePose(i))));
  }
  const Reconstruction result = system.Finish();
  ASSERT_EQ(result.maps.size(), 2u);
  EXPECT_EQ(result.lost, 1);
  EXPECT_EQ(result.maps[0].tracked, 60);
  EXPECT_GE(result.maps[1].tracked, 60);
  EXPECT_GT(result.maps[0].landmarks, 100);
  EXPECT_GT(result.maps[1].landmarks, 100);
}

TEST(SystemSlow, FindsItselfAgainWhereverItIsPutAndHoweverItIsTurned) {
  const BoxRoom room = Hall();
  System system(kCamera, SmallOptions(), {});
  for (int i = 0; i < 90; ++i) {
    system.Process(MakeFrame(i, room.Render(kCamera, TruePose(i))));
  }
  const cv::Mat black = cv::Mat::zeros(kCamera.height(), kCamera.width(), CV_8UC3);
  const std::array<Eigen::Vector3d, 3> turns = {
      Eigen::Vector3d(0, 0, 3), Eigen::Vector3d(1.5, 0, 0), Eigen::Vector3d(0.5, -2, 1)};
  std::vector<double> frames = Count(90);
  for (size_t t = 0; t < turns.size(); ++t) {
    for (int i = 0; i < 5; ++i, frames.push_back(-1)) {
      EXPECT_NE(system.Process(MakeFrame(static_cast<int>(frames.size()), black)).state,
                TrackingState::kTracking);
    }
    const double place = 10.5 + 20.0 * static_cast<double>(t);
    Rigid3 pose = TruePose(place);
    pose.rotation = pose.rotation * ExpSo3(turns[t]);
    const int index = static_cast<int>(frames.size());
    EXPECT_EQ(system.Process(MakeFrame(index, room.Render(kCamera, pose))).state,
              TrackingState::kTracking);
    frames.push_back(place);
  }
  Reconstruction result = system.Finish();
  EXPECT_EQ(result.maps.size(), 1u);
  EXPECT_EQ(result.relocalized, 3);
  ASSERT_EQ(result.frames.size(), 93u);
  EXPECT_LT(Compare(result.frames, frames).rmse, 0.01 * 1.3 * 90 / 25);
}

TEST(SystemSlow, LocatesTheCameraInAMapOfAnEarlierRunAndLeavesItAsItIs) {
  const BoxRoom room = Hall();
  System earlier(kCamera, SmallOptions(), {});
  for (int i = 0; i < 90; ++i) earlier.Process(MakeFrame(i, room.Render(kCamera, TruePose(i))));
  earlier.Finish();
  ASSERT_EQ(earlier.maps().size(), 1u);
  const Map& map = earlier.maps().front();
  std::vector<Eigen::Vector3d> found, expected;
  for (const KeyframeId id : map.KeyframeIds()) {
    found.push_back(map.keyframe(id).world_from_camera.translation);
    expected.push_back(TruePose(map.keyframe(id).frame_index).translation);
  }
  const Similarity3 fit = AlignSimilarity(found, expected).value();

  System later(kCamera, SmallOptions(), {});
  later.StartIn(map, earlier.grounds().front(), /*is_kept=*/true);
  std::vector<double> frames;
  for (int i = 0; i < 30; ++i) {
    frames.push_back(70.5 - 2 * i);  // the other way
    const FrameReport report =
        later.Process(MakeFrame(i, room.Render(kCamera, TruePose(frames.back()))));
    ASSERT_TRUE(report.world_from_camera.has_value()) << i;
    const Eigen::Vector3d place = fit * report.world_from_camera->translation;
    EXPECT_LT((place - TruePose(frames.back()).translation).norm(), 0.05) << i;
  }
  const Reconstruction result = later.Finish();
  EXPECT_EQ(result.lost, 0);
  EXPECT_EQ(result.initialized_at, 0);
  ASSERT_EQ(later.maps().size(), 1u);
  EXPECT_EQ(later.maps().front().num_keyframes(), map.num_keyframes());
  EXPECT_EQ(later.maps().front().num_landmarks(), map.num_landmarks());
}

TEST(SystemSlow, GoesOnInAMapOfAnEarlierRun) {
  const BoxRoom room = Hall();
  System earlier(kCamera, SmallOptions(), {});
  for (int i = 0; i < 60; ++i) earlier.Process(MakeFrame(i, room.Render(kCamera, TruePose(i))));
  earlier.Finish();
  System later(kCamera, SmallOptions(), {});
  later.StartIn(earlier.maps().front(), earlier.grounds().front(), /*is_kept=*/false);
  std::vector<double> frames;
  for (int i = 0; i < 60; ++i) {
    frames.push_back(50 + i);
    later.Process(MakeFrame(i, room.Render(kCamera, TruePose(frames.back()))));
  }
  const Reconstruction result = later.Finish();
  EXPECT_EQ(result.maps.size(), 1u);
  ASSERT_EQ(result.frames.size(), 60u);
  EXPECT_GT(later.maps().front().num_keyframes(), earlier.maps().front().num_keyframes());
  EXPECT_LT(result.keyframes.front().index, 0);  // of the earlier run
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.01 * error.length);
}

TEST(System, GivesNothingButDoesNotFailOnAWorldWithoutTexture) {
  System system(kCamera, SmallOptions(), {});
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
  System system(kCamera, SmallOptions(), {});
  EXPECT_THROW(system.Process(MakeFrame(0, cv::Mat(100, 200, CV_8UC3))), ContractError);
}

}  // namespace
}  // namespace orb360
