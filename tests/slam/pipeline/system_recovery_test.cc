// System's part that finds a lost camera again, and goes on in other maps.

#include <array>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "slam/features/sphere_pyramid.h"  // printed by an assertion
#include "tests/slam/pipeline/hall_walk.h"
#include <orb360/slam/io/map_file.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {
namespace {

TEST(SystemSlow, FindsItselfAgainAfterAShortBlackout) {
  const BoxRoom room = Hall();
  System system(kHallCamera, SmallOptions(), {});
  std::vector<double> frames;
  for (int i = 0; i < 90; ++i) {
    frames.push_back(i);
    const cv::Mat image = room.Render(kHallCamera, TruePose(i));
    const bool black = i >= 50 && i < 60;
    system.Process(MakeFrame(i, black ? cv::Mat(cv::Mat::zeros(image.size(), CV_8UC3)) : image));
  }
  const Reconstruction result = system.Finish();
  EXPECT_EQ(result.lost, 1);
  EXPECT_EQ(result.maps.size(), 1u);
  EXPECT_EQ(result.frames.size(), 90u);
  EXPECT_GE(result.interpolated, 9);
  EXPECT_LE(result.interpolated, 10);
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.01 * error.length);
}

// After a covered frame, most of the image shows another place of the map, as a screen would. The
// motion before tells which of both views is the true one.
TEST(SystemSlow, GoesOnWhereTheMotionHasTakenItAfterSomethingCoveredTheView) {
  const BoxRoom room = Hall();
  System system(kHallCamera, SmallOptions(), {});
  std::vector<FrameReport> reports;
  for (int i = 0; i < 52; ++i) {
    cv::Mat image = room.Render(kHallCamera, TruePose(i));
    if (i == 50) image.setTo(0);
    if (i == 51) {
      const cv::Mat elsewhere = room.Render(kHallCamera, TruePose(20));
      elsewhere.colRange(0, image.cols * 5 / 8).copyTo(image.colRange(0, image.cols * 5 / 8));
    }
    reports.push_back(system.Process(MakeFrame(i, image)));
  }
  EXPECT_EQ(reports[50].state, TrackingState::kLost);
  ASSERT_EQ(reports[51].state, TrackingState::kTracking);
  const auto distance = [&](int from, int to) {
    return (reports[to].world_from_camera.value().translation -
            reports[from].world_from_camera.value().translation)
        .norm();
  };
  EXPECT_NEAR(distance(49, 51), 2 * distance(48, 49), 0.2 * distance(48, 49));
}

TEST(SystemSlow, BeginsANewMapElsewhereAndKeepsTheOldOne) {
  const BoxRoom first = Hall(1);
  const BoxRoom second = Hall(99);
  System system(kHallCamera, SmallOptions(), {});
  for (int i = 0; i < 130; ++i) {
    const BoxRoom& room = i < 60 ? first : second;
    system.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(i))));
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
  System system(kHallCamera, SmallOptions(), {});
  for (int i = 0; i < 90; ++i) {
    system.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(i))));
  }
  const cv::Mat black = cv::Mat::zeros(kHallCamera.height(), kHallCamera.width(), CV_8UC3);
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
    EXPECT_EQ(system.Process(MakeFrame(index, room.Render(kHallCamera, pose))).state,
              TrackingState::kTracking);
    frames.push_back(place);
  }
  Reconstruction result = system.Finish();
  EXPECT_EQ(result.maps.size(), 1u);
  EXPECT_EQ(result.relocalized, 3);
  ASSERT_EQ(result.frames.size(), 93u);
  EXPECT_EQ(result.interpolated, 0) << "nobody knows the way";
  EXPECT_LT(Compare(result.frames, frames).rmse, 0.01 * 1.3 * 90 / 25);
}

// Two maps of one hall, of which the first shows one half of the walls and the second the other,
// until both are seen.
TEST(SystemSlow, MergesTwoMapsWhereItSeesWhatIsInBoth) {
  const BoxRoom room = Hall();
  System system(kHallCamera, SmallOptions(), {});
  std::vector<double> frames;
  const cv::Rect left(0, 0, kHallCamera.width() / 2, kHallCamera.height());
  const cv::Rect right(kHallCamera.width() / 2, 0, kHallCamera.width() / 2, kHallCamera.height());
  for (int i = 0; i < 190; ++i) {
    // There, once more from the beginning, and back.
    frames.push_back(i < 60 ? i : i < 130 ? i - 60 : 259 - 1.5 * i);
    cv::Mat image = room.Render(kHallCamera, TruePose(frames.back()));
    if (i < 60) image(right).setTo(cv::Scalar::all(128));
    if (i >= 60 && i < 130) image(left).setTo(cv::Scalar::all(128));
    const FrameReport report = system.Process(MakeFrame(i, image));
    if (i == 129) {
      EXPECT_EQ(report.map, 1);  // the second one
    }
  }
  const Reconstruction result = system.Finish();
  EXPECT_EQ(result.maps.size(), 1u);
  EXPECT_EQ(result.merges.size(), 1u);
  EXPECT_GE(result.frames.size(), 185u);
  EXPECT_LT(Compare(result.frames, frames).rmse, 0.01);
}

TEST(SystemSlow, LocatesTheCameraInAMapOfAnEarlierRunAndLeavesItAsItIs) {
  const BoxRoom room = Hall();
  System earlier(kHallCamera, SmallOptions(), {});
  for (int i = 0; i < 90; ++i) earlier.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(i))));
  earlier.Finish();
  ASSERT_EQ(earlier.maps().size(), 1u);
  const Map& map = earlier.maps().front();
  std::vector<Eigen::Vector3d> found, expected;
  for (const KeyframeId id : map.KeyframeIds()) {
    found.push_back(map.keyframe(id).world_from_camera.translation);
    expected.push_back(TruePose(map.keyframe(id).frame_index).translation);
  }
  const Similarity3 fit = AlignSimilarity(found, expected).value();

  System later(kHallCamera, SmallOptions(), {});
  later.Localize({.ground = earlier.grounds().front(), .map = map});
  std::vector<double> frames;
  for (int i = 0; i < 30; ++i) {
    frames.push_back(70.5 - 2 * i);  // the other way
    const FrameReport report =
        later.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(frames.back()))));
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
  // The keyframes of the map were somewhere else at these times.
  for (const FramePose& frame : result.frames) {
    const Eigen::Vector3d place = fit * frame.world_from_camera.translation;
    EXPECT_LT((place - TruePose(frames[frame.index]).translation).norm(), 0.05) << frame.index;
  }
}

TEST(SystemSlow, GoesOnInAMapOfAnEarlierRun) {
  const BoxRoom room = Hall();
  System earlier(kHallCamera, SmallOptions(), {});
  for (int i = 0; i < 60; ++i) earlier.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(i))));
  earlier.Finish();
  const Map& map = earlier.maps().front();
  int aligned = 0;
  int observed = 0;
  for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
    if (!map.HasLandmark(id)) continue;
    for (const Observation& o : map.landmark(id).observations) {
      ++observed;
      aligned += o.aligned_sigma > 0;
    }
  }
  EXPECT_GT(aligned, 0.6 * observed);
  for (const KeyframeId id : map.KeyframeIds()) EXPECT_EQ(map.keyframe(id).image, nullptr);
  System later(kHallCamera, SmallOptions(), {});
  later.LoadMap({.ground = earlier.grounds().front(), .map = map});
  std::vector<double> frames;
  for (int i = 0; i < 60; ++i) {
    frames.push_back(50 + i);
    later.Process(MakeFrame(i, room.Render(kHallCamera, TruePose(frames.back()))));
  }
  // A receiver that contradicts the map does not change its unit, which others use.
  Positions positions;
  for (size_t i = 0; i < frames.size(); ++i) {
    positions.fixes.push_back(
        {static_cast<double>(i) / 25.0, 1.3 * TruePose(frames[i]).translation, 0.01});
  }
  const Reconstruction result = later.Finish(positions);
  EXPECT_EQ(result.scale.state, ScaleState::kRough);
  EXPECT_NEAR(Compare(result.frames, frames).scale, 1.0, 0.03);
  EXPECT_EQ(result.maps.size(), 1u);
  ASSERT_EQ(result.frames.size(), 60u);
  EXPECT_GT(later.maps().front().num_keyframes(), earlier.maps().front().num_keyframes());
  EXPECT_LT(result.keyframes.front().index, 0);  // of the earlier run
  const PathError error = Compare(result.frames, frames);
  EXPECT_LT(error.rmse, 0.01 * error.length);
}

}  // namespace
}  // namespace orb360
