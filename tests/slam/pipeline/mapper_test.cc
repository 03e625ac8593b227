#include "slam/pipeline/mapper.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "slam/features/sphere_pyramid.h"
#include "slam/pipeline/landmark_fusion.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

TrackedFrame FrameSeeing(const SyntheticScene&, std::shared_ptr<const Features> features,
                         const Rigid3& pose, int num_tracked) {
  TrackedFrame frame;
  frame.index = 40;
  frame.timestamp = 4.0;
  frame.world_from_camera = pose;
  frame.landmarks.assign(features->size(), kNoId);
  for (int i = 0; i < num_tracked; ++i) frame.landmarks[i] = i;
  frame.features = std::move(features);
  return frame;
}

TEST(Mapper, TakesAFrameInAndCorrectsItsPose) {
  SyntheticScene scene(600);
  Map map = scene.MakeMap(Walk(3, {-0.4, 0.1, 0.0}), 250);
  const Rigid3 truth = Walk(4, {-0.4, 0.1, 0.0})[3];
  Rigid3 disturbed = truth;
  disturbed.translation += Eigen::Vector3d(0.03, -0.03, 0.02);
  const KeyframeId id = IntegrateKeyframe(FrameSeeing(scene, scene.See(truth), disturbed, 250),
                                          nullptr, {}, {}, {}, &map);
  map.CheckConsistency();
  EXPECT_EQ(id, 3);
  EXPECT_EQ(map.keyframe(id).frame_index, 40);
  EXPECT_LT((map.keyframe(id).world_from_camera.translation - truth.translation).norm(), 0.015);
  EXPECT_GT(map.num_landmarks(), 350);  // the other points, triangulated
}

TEST(Mapper, DropsLandmarksThatAreRarelyFound) {
  SyntheticScene scene(300);
  Map map = scene.MakeMap(Walk(3, {-0.4, 0.1, 0.0}), 300);
  const LandmarkId doubtful = 17;
  map.landmark(doubtful).visible = 20;
  map.landmark(doubtful).found = 1;
  const Rigid3 pose = Walk(4, {-0.4, 0.1, 0.0})[3];
  TrackedFrame frame = FrameSeeing(scene, scene.See(pose), pose, 300);
  frame.landmarks[doubtful] = kNoId;
  IntegrateKeyframe(frame, nullptr, {}, {}, {}, &map);
  EXPECT_FALSE(map.HasLandmark(doubtful));
}

TEST(Mapper, RemovesKeyframesThatOthersMakeRedundantAndKeepsTheirPoses) {
  SyntheticScene scene(300);
  // Five keyframes of the same points from almost the same place.
  const std::vector<Rigid3> poses = Walk(5, {-0.05, 0.0, 0.0});
  Map map = scene.MakeMap(poses, 300);
  const Rigid3 pose = Walk(6, {-0.05, 0.0, 0.0})[5];
  IntegrateKeyframe(FrameSeeing(scene, scene.See(pose), pose, 300), nullptr, {}, {}, {}, &map);
  map.CheckConsistency();
  EXPECT_LT(map.num_keyframes(), 6);
  EXPECT_TRUE(map.HasKeyframe(0));  // the gauge
  for (KeyframeId id = 0; id < 5; ++id) {
    EXPECT_LT((map.PoseOf(id).translation - poses[id].translation).norm(), 0.02) << id;
  }
}

TEST(Mapper, KeepsTheImagesOfTheNewestKeyframesOnly) {
  SyntheticScene scene(300);
  const std::vector<Rigid3> poses = Walk(8, {-0.4, 0.1, 0.0});
  Map map = scene.MakeMap({poses.begin(), poses.begin() + 3}, 250);
  cv::Mat gray(256, 512, CV_8U);
  cv::randu(gray, 0, 256);
  auto image = std::make_shared<SpherePyramid>();
  BuildSpherePyramid(gray, 8, image.get());
  MapperOptions options;
  options.redundant_fraction = 1.1;  // no keyframe goes
  options.kept_images = 2;
  for (int k = 3; k < 8; ++k) {
    TrackedFrame frame = FrameSeeing(scene, scene.See(poses[k]), poses[k], 200);
    for (LandmarkId& id : frame.landmarks) id = map.Resolve(id);
    IntegrateKeyframe(frame, image, options, {}, {}, &map);
  }
  for (KeyframeId id = 0; id < 8; ++id) EXPECT_EQ(map.keyframe(id).image != nullptr, id >= 6);
  EXPECT_EQ(image.use_count(), 3);
}

TEST(LandmarkFusion, MergesTwoLandmarksOfOnePoint) {
  SyntheticScene scene(200);
  const std::vector<Rigid3> poses = Walk(4, {-0.4, 0.1, 0.0});
  Map map = scene.MakeMap(poses, 150, /*noise=*/0.3);
  // Point 180 twice: seen by the first two keyframes and by the last two.
  std::vector<LandmarkId> twins;
  for (const int first : {0, 2}) {
    twins.push_back(map.AddLandmark(scene.points[180].position, {}));
    map.AddObservation(twins.back(), first, 180);
    map.AddObservation(twins.back(), first + 1, 180);
    map.UpdateAppearance(twins.back());
  }
  FuseWithNeighbours(3, 10, &map);
  map.CheckConsistency();
  ASSERT_EQ(map.Resolve(twins[0]), map.Resolve(twins[1]));
  EXPECT_EQ(map.landmark(map.Resolve(twins[0])).observations.size(), 4u);
}

TEST(LandmarkFusion, AddsObservationsThatWereMissed) {
  SyntheticScene scene(200);
  Map map = scene.MakeMap(Walk(4, {-0.4, 0.1, 0.0}), 150, /*noise=*/0.3);
  map.RemoveObservation(20, 1);
  FuseWithNeighbours(3, 10, &map);
  EXPECT_EQ(map.keyframe(1).landmarks[20], 20);
}

}  // namespace
}  // namespace orb360
