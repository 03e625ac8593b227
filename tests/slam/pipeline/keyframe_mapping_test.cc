#include "slam/pipeline/keyframe_mapping.h"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "slam/pipeline/ground_steps.h"
#include "tests/slam/scale/ground_scene.h"

namespace orb360 {
namespace {

constexpr double kHeight = 1.5;
constexpr double kStep = 1.1;

Rigid3 TruePose(int i) { return {ExpSo3({0.0, 0.02, 3.0 + 0.03 * i}), {kStep * i, 0.0, kHeight}}; }

std::shared_ptr<const SpherePyramid> ImageAt(int i) {
  const Asphalt asphalt(21);
  const Ground ground = [&](const Eigen::Vector2d& p) { return asphalt(p / kHeight); };
  return std::make_shared<const SpherePyramid>(LookAtGround(TruePose(i), ground));
}

// Maps frame `index` as the next keyframe.
MappedKeyframe MapNext(Map map, int index, std::shared_ptr<const SpherePyramid> image,
                       const std::optional<KnownGround>& ground) {
  Options options;
  options.loop.enabled = false;
  const TrackedFrame frame{.index = index,
                           .timestamp = 0.1 * index,
                           .features = std::make_shared<Features>(),
                           .world_from_camera = TruePose(index),
                           .landmarks = {}};
  KeyframeMapping job{.active = {std::move(map), LoopDetector({}, {}, 12, 0.001)},
                      .finished = {},
                      .frame = frame,
                      .pyramid = std::move(image),
                      .ground = ground};
  return MapKeyframe(std::move(job), options);
}

TEST(KeyframeMapping, MeasuresTheFirstStepsOnceItKnowsTheGround) {
  Map map;
  for (int i = 0; i < 6; ++i) {
    const KeyframeId id = map.AddKeyframe(i, 0.1 * i, TruePose(i), std::make_shared<Features>());
    map.keyframe(id).image = ImageAt(i);
    if (i >= 3) MeasureGroundSteps(id, std::nullopt, {}, &map);
  }
  // Two views of far landmarks have told that the camera stood almost still at first.
  for (const KeyframeId id : {0, 1}) {
    map.keyframe(id).world_from_camera.translation =
        TruePose(2).translation - Eigen::Vector3d(0.03 * (2 - id), 0, 0);
  }
  const MappedKeyframe mapped = MapNext(std::move(map), 6, ImageAt(6), std::nullopt);
  ASSERT_TRUE(mapped.ground.has_value());
  EXPECT_NEAR(mapped.ground->camera_height, kHeight, 0.02);
  const Map& result = mapped.active.map;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d step = result.PoseOf(i + 1).translation - result.PoseOf(i).translation;
    EXPECT_NEAR(step.norm(), kStep, 0.03) << i;
  }
}

TEST(KeyframeMapping, EnlargesTheMapOnceTheDistanceBetweenTheLensesIsCertain) {
  Map map;
  for (int i = 0; i < 15; ++i) {
    const KeyframeId id = map.AddKeyframe(i, 0.1 * i, TruePose(i), std::make_shared<Features>());
    if (i == 0) continue;
    map.keyframe(id).ground_steps.push_back({.keyframe = id - 1,
                                             .ratio = kStep / kHeight,
                                             .sigma = 0.002,
                                             .direction1 = Eigen::Vector3d::UnitX(),
                                             .direction2 = Eigen::Vector3d::UnitX(),
                                             .per_lens_distance = 1,
                                             .lens_distance = {0.02, 0.002}});
  }
  const KnownGround ground{.up = Eigen::Vector3d::UnitZ(), .camera_height = kHeight};
  const MappedKeyframe mapped = MapNext(std::move(map), 15, nullptr, ground);
  EXPECT_TRUE(mapped.changes_unit);
  ASSERT_TRUE(mapped.ground.has_value());
  const double ratio = kStep / kHeight;
  EXPECT_NEAR(mapped.ground->camera_height, kHeight * ratio / (ratio + 0.02), 1e-6);
}

}  // namespace
}  // namespace orb360
