#include "slam/viewer/live_feed.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/byte_number.h"
#include "slam/io/optical_frame.h"

namespace orb360 {
namespace {

/// A frame with two corners of three features; the last, which shows the second corner on a coarser
/// level, is tracked.
class LiveFeedTest : public testing::Test {
 protected:
  LiveFeedTest() {
    frame_.index = 7;
    frame_.timestamp = 0.35;
    frame_.image = cv::Mat(50, 100, CV_8UC3, cv::Scalar(1, 2, 3));
    for (const float u : {25.0f, 50.0f, 50.0f}) {
      Keypoint keypoint{};
      keypoint.pixel = {u, 10.0f};
      features_.keypoints.push_back(keypoint);
    }
    features_.bearings.resize(3);
    features_.descriptors.resize(3);
    features_.corners = {0, 1, 1};
    map_from_camera_.translation = {-2, 0, 0};  // two units ahead of the map's origin
  }

  PresentState State() const {
    PresentState state{.frame = frame_, .state = TrackingState::kTracking, .features = features_};
    state.landmarks = landmarks_;
    state.map_from_camera = map_from_camera_;
    return state;
  }

  nlohmann::json Json(std::uint64_t since = 0) {
    return nlohmann::json::parse(table_.at("live.json").make_since(since));
  }

  Frame frame_;
  Features features_;
  std::vector<LandmarkId> landmarks_ = {kNoId, kNoId, 4};
  Rigid3 map_from_camera_;
  LiveFeed::Clock::time_point now_;
  std::chrono::seconds per_look_{0};  // that pass with each look at the clock
  LiveFeed feed_{[this] { return now_ += per_look_; }};
  ResourceTable table_ = feed_.Resources();
};

TEST_F(LiveFeedTest, ShowsTheFrameWithItsFeatures) {
  EXPECT_EQ(Json()["size"][0], 0);  // Nothing is there yet.
  feed_.Take(State());
  const nlohmann::json json = Json();
  EXPECT_EQ(json["frame"], 7);
  EXPECT_EQ(json["time"], 0.35);
  EXPECT_GE(json["age"], 0.0);
  EXPECT_EQ(json["state"], "tracking");
  EXPECT_THAT(json["size"].get<std::vector<int>>(), testing::ElementsAre(100, 50));
  EXPECT_EQ(json["isPaused"], false);
  const std::string image = table_.at("live.image").make();
  EXPECT_EQ(ReadNumber<std::uint32_t>(image, 0, std::endian::little), 7U);
  ASSERT_EQ(ReadNumber<std::uint32_t>(image, 4, std::endian::little), 2U);
  std::vector<int> features;
  for (size_t at = 8; at < 20; at += 2) {
    features.push_back(*ReadNumber<std::uint16_t>(image, at, std::endian::little));
  }
  EXPECT_THAT(features, testing::ElementsAre(2500, 2000, 0, 5000, 2000, 1));
  EXPECT_THAT(image.substr(20), testing::StartsWith("\xff\xd8"));
}

TEST_F(LiveFeedTest, ShowsWhatIsLeftOutOfTheImages) {
  EXPECT_EQ(Json()["isMasked"], false);
  EXPECT_EQ(table_.at("live.mask").make(), "");
  cv::Mat mask(1000, 2000, CV_8U, cv::Scalar(255));
  mask.rowRange(900, 1000) = 0;
  feed_.SetMask(mask);
  EXPECT_EQ(Json()["isMasked"], true);
  const std::string bytes = table_.at("live.mask").make();
  const cv::Mat shown = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), -1);
  ASSERT_EQ(shown.type(), CV_8UC1);
  ASSERT_EQ(shown.size(), cv::Size(1280, 640));
  EXPECT_EQ(shown.at<std::uint8_t>(570, 7), 255);
  EXPECT_EQ(shown.at<std::uint8_t>(580, 7), 0);
}

TEST_F(LiveFeedTest, ShowsTheTimesOfTheLastThreeHundredFrames) {
  EXPECT_TRUE(Json()["times"].empty());
  for (int i = 0; i < 500; ++i) feed_.AddTimes({{"frame", i}, {"tracking", 2.5}});
  const nlohmann::json times = Json()["times"];
  EXPECT_EQ(times["frame"]["median"], 349);  // of 200 to 499
  EXPECT_EQ(times["frame"]["p95"], 484);
  EXPECT_EQ(times["tracking"]["p95"], 2.5);
}

TEST_F(LiveFeedTest, BeginsTheWorldAtTheFirstCamera) {
  feed_.Take(State());
  const nlohmann::json pose = Json()["pose"];
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(pose[axis].get<double>(), 0, 1e-9);
  map_from_camera_.translation = {-5, 0, 0};
  feed_.Take(State());
  EXPECT_NEAR(Json()["pose"][0].get<double>(), 3, 1e-9);  // x is forward.
}

TEST_F(LiveFeedTest, CopiesTheMapOnlyForThosePagesThatAsk) {
  Map map;
  PresentState state = State();
  state.map = &map;
  feed_.Take(state);
  EXPECT_EQ(Json()["revision"], 1);  // It asks for the next copy.
  for (int i = 8; i < 20; ++i) {
    frame_.index = i;
    feed_.Take(state);
  }
  const nlohmann::json json = Json();
  EXPECT_EQ(json["revision"], 2);
  EXPECT_EQ(json["frame"], 8) << "later frames were not asked for";
}

TEST_F(LiveFeedTest, CopiesTheMapInAHundredthOfTheTime) {
  per_look_ = std::chrono::seconds(1);  // A copy takes one second.
  Map map;
  PresentState state = State();
  state.map = &map;
  int num_frames = 0;
  for (int revision = 0; revision < 4; ++num_frames) {
    frame_.index = num_frames;
    feed_.Take(state);
    const nlohmann::json json = Json();
    EXPECT_EQ(json["frame"], num_frames) << "frames are shown although the map is not copied";
    revision = json["revision"];
  }
  EXPECT_EQ(num_frames, 3 * 100 + 1);
}

TEST_F(LiveFeedTest, IsFinishingWhenNoFurtherFrameComes) {
  feed_.Take(State());
  EXPECT_EQ(Json()["state"], "tracking");
  feed_.End();
  EXPECT_EQ(Json()["state"], "finishing");
  table_.at("pause").make();
  EXPECT_FALSE(feed_.WaitForTurn([] { return false; })) << "there is nothing left to wait for";
}

TEST_F(LiveFeedTest, PausesStepsAndEndsTheRun) {
  const auto never = [] { return false; };
  EXPECT_TRUE(feed_.WaitForTurn(never));
  table_.at("pause").make();
  std::atomic<int> num_turns = 0;
  std::atomic<bool> has_ended = false;
  EXPECT_EQ(Json()["isWaiting"], false);
  std::thread run([&] {
    while (feed_.WaitForTurn(never)) ++num_turns;
    has_ended = true;
  });
  const auto wait_for = [&](auto condition) {
    for (int i = 0; i < 500 && !condition(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return condition();
  };
  EXPECT_TRUE(wait_for([&] { return Json()["isWaiting"] == true; }));
  EXPECT_EQ(num_turns, 0);
  for (int step = 1; step <= 3; ++step) {
    table_.at("step").make();
    EXPECT_TRUE(wait_for([&] { return num_turns == step; }));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_EQ(num_turns, 3);
  table_.at("resume").make();
  EXPECT_TRUE(wait_for([&] { return num_turns > 100; }));
  table_.at("finish").make();
  EXPECT_TRUE(wait_for([&] { return has_ended.load(); }));
  run.join();
}

TEST_F(LiveFeedTest, DoesNotKeepAPausedRunFromBeingInterrupted) {
  table_.at("pause").make();
  EXPECT_TRUE(feed_.WaitForTurn([] { return true; }));
}

TEST_F(LiveFeedTest, ChangesNothingByRequestsThatAreNotActions) {
  for (const auto& [path, resource] : table_) {
    EXPECT_EQ(resource.is_action, !path.starts_with("live.")) << path;
  }
}

TEST_F(LiveFeedTest, SendsPosesAgainOnlyWhereTheyHaveChanged) {
  Map map;
  map.AddKeyframe(7, 0.35, Rigid3(), std::make_shared<Features>());
  PresentState state = State();
  state.map = &map;
  feed_.Take(state);
  nlohmann::json json = Json();
  EXPECT_EQ(json["revision"], 1);
  EXPECT_EQ(json["keyframes"].size(), 1U);
  EXPECT_EQ(Json(1)["keyframes"], nullptr);
  EXPECT_EQ(Json(1)["links"], nullptr);
  // The ground levels the world, and all poses with it.
  state.map = nullptr;
  state.ground = KnownGround{.up = Eigen::Vector3d(0.1, 0, 1).normalized(), .camera_height = 1.6};
  feed_.Take(state);
  json = Json(1);
  EXPECT_EQ(json["revision"], 2);
  EXPECT_EQ(json["keyframes"].size(), 1U);
}

TEST_F(LiveFeedTest, ShowsWhatBecomesOfTheRunAfterItsLastFrame) {
  feed_.Take(State());
  EXPECT_EQ(Json()["progress"], nullptr);
  Map map;
  map.AddKeyframe(7, 0.35, Rigid3(), std::make_shared<Features>());
  const std::vector<Map> maps(2, map);
  Rigid3 world_from_map;
  world_from_map.translation = {1, 2, 3};
  feed_.ShowFinished(maps, world_from_map);
  feed_.ShowProgress({"computing depth", 3, 9, "steps"});
  nlohmann::json json = Json();
  ASSERT_EQ(json["keyframes"].size(), 2U);
  EXPECT_NE(json["keyframes"][0][0], json["keyframes"][1][0]) << "two keyframes with one id";
  EXPECT_EQ(json["keyframes"][0][2], 1);
  EXPECT_EQ(json["pose"], nullptr);
  EXPECT_EQ(json["progress"]["what"], "computing depth");
  EXPECT_EQ(json["progress"]["done"], 3);
  EXPECT_EQ(json["progress"]["count"], 9);
  EXPECT_EQ(json["views"], 0);
  DenseDepth depth{cv::Mat(8, 16, CV_32FC1, cv::Scalar(2)), cv::Mat(8, 16, CV_32FC1, cv::Scalar(1)),
                   cv::Mat(8, 16, CV_8UC3, cv::Scalar(30, 20, 10))};
  feed_.AddView(7, Rigid3(), depth);
  EXPECT_EQ(Json()["views"], 1);
  const std::string bytes = table_.at("live.cloud").make_since(0);
  EXPECT_EQ(*ReadNumber<std::int32_t>(bytes, 8, std::endian::little), 7);
  EXPECT_EQ(*ReadNumber<float>(bytes, 12, std::endian::little), 1) << "not in the world of files";
}

}  // namespace
}  // namespace orb360
