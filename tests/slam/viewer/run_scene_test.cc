#include "slam/viewer/run_scene.h"

#include <map>
#include <random>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

using testing::ElementsAre;

/// Frames along x, every third a keyframe, which observes landmarks around its own number.
SparseModel Model(int num_frames) {
  SparseModel model;
  model.points.resize(5000);
  for (int i = 0; i < num_frames; ++i) {
    PosedFrame frame;
    frame.index = 2 * i;
    frame.timestamp = 0.1 * i;
    frame.is_keyframe = i % 3 == 0;
    frame.world_from_optical.translation = {0.5 * i, 0, 0};
    if (frame.is_keyframe) {
      for (int p = 0; p < 100; ++p)
        frame.observations.push_back({Eigen::Vector2f::Zero(), i / 3 * 12 + p});
    }
    model.frames.push_back(frame);
  }
  return model;
}

TEST(LinkKeyframes, ConnectsThoseThatShareMostLandmarks) {
  const std::vector<KeyframeLink> links = LinkKeyframes(Model(90));
  std::map<std::pair<int, int>, int> shared;
  std::map<int, int> degrees;
  for (const KeyframeLink& link : links) {
    EXPECT_LT(link.first, link.second);
    EXPECT_TRUE(shared.emplace(std::pair(link.first, link.second), link.shared).second);
    // Neighbours differ by 12 landmarks of 100.
    EXPECT_EQ(link.shared, 100 - 12 * (link.second - link.first));
    EXPECT_GE(link.shared, 15);
    ++degrees[link.first];
    ++degrees[link.second];
  }
  EXPECT_TRUE(shared.contains({10, 11}));
  EXPECT_TRUE(shared.contains({10, 14}));
  EXPECT_FALSE(shared.contains({10, 18}));
  EXPECT_EQ(degrees[15], 8);
}

TEST(LinkKeyframes, HasNoneWithoutObservations) {
  SparseModel model = Model(30);
  for (PosedFrame& frame : model.frames) frame.observations.clear();
  EXPECT_THAT(LinkKeyframes(model), testing::IsEmpty());
}

TEST(SceneJson, HasWhatThePageShows) {
  RunScene scene;
  scene.folder = "out/run";
  scene.model = Model(12);
  scene.summary = {{"input", "walk.mp4"},
                   {"scale", {{"state", "metric"}, {"sigma", 0.02}}},
                   {"loop_times", {{1.02, 0.0}}},
                   {"merge_frames", {{22, 6}, {20, -5}}}};
  scene.scales = {{0.3, 1.01, 0.02}};
  scene.images = {0, 6};
  scene.views = {6, 12};
  scene.voxel_size = 0.04;
  scene.missing = {"Something."};
  const nlohmann::json json = nlohmann::json::parse(SceneJson(scene));
  EXPECT_EQ(json["unit"], "m");
  EXPECT_EQ(json["summary"]["input"], "walk.mp4");
  EXPECT_EQ(json["frames"]["index"].size(), 12U);
  EXPECT_EQ(json["frames"]["position"].size(), 36U);
  EXPECT_EQ(json["frames"]["orientation"].size(), 48U);
  EXPECT_EQ(json["frames"]["position"][3 * 4], 2.0);
  EXPECT_THAT(json["keyframes"].get<std::vector<int>>(), ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(json["loops"][0].get<std::vector<int>>(), ElementsAre(10, 0));
  // The merge with a frame that is there.
  ASSERT_EQ(json["loops"].size(), 2U);
  EXPECT_THAT(json["loops"][1].get<std::vector<int>>(), ElementsAre(11, 3));
  EXPECT_EQ(json["scale"]["value"][0], 1.01);
  EXPECT_THAT(json["views"].get<std::vector<int>>(), ElementsAre(6, 12));
  EXPECT_THAT(json["images"].get<std::vector<int>>(), ElementsAre(0, 6));
  EXPECT_EQ(json["voxelSize"], 0.04);
  EXPECT_EQ(json["missing"][0], "Something.");
}

TEST(SceneJson, HasUnitsWhereTheScaleIsUnknownAndWhereNothingIsStated) {
  RunScene scene;
  scene.summary = {{"scale", {{"state", "unknown"}}}};
  EXPECT_EQ(nlohmann::json::parse(SceneJson(scene))["unit"], "units");
  scene.summary = nlohmann::json::object();
  EXPECT_EQ(nlohmann::json::parse(SceneJson(scene))["unit"], "units");
  EXPECT_TRUE(nlohmann::json::parse(SceneJson(scene))["voxelSize"].is_null());
}

TEST(SceneJson, SurvivesNamesThatAreNotText) {
  RunScene scene;
  scene.summary = nlohmann::json::object();
  scene.folder = "caf\xe9";
  EXPECT_EQ(nlohmann::json::parse(SceneJson(scene))["folder"], "caf\xef\xbf\xbd");
}

}  // namespace
}  // namespace orb360
