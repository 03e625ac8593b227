#include "slam/pipeline/lens_distance.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/slam/map/true_ground_step.h"

namespace orb360 {
namespace {

constexpr double kHeight = 1.5;
constexpr double kDistance = 0.02;  // heights

Rigid3 PoseAt(int i) { return {ExpSo3({0, 0, 0.1}), {1.2 * i, 0.0, kHeight}}; }

// A map whose steps look too short by the distance between the lenses, and tell it with `sigma`.
Map SeenThroughLenses(int num_keyframes, double sigma, double distance = kDistance) {
  Map map;
  for (int i = 0; i < num_keyframes; ++i) {
    const KeyframeId id = map.AddKeyframe(i, 0.1 * i, PoseAt(i), std::make_shared<Features>());
    if (i == 0) continue;
    GroundStepFrom step = TrueGroundStep(i - 1, PoseAt(i - 1), PoseAt(i), kHeight);
    step.ratio -= distance;
    step.point1 -= 0.5 * distance * step.direction1;
    step.point2 += 0.5 * distance * step.direction2;
    step.per_lens_distance = 1;
    step.lens_distance = {distance, sigma};
    map.keyframe(id).ground_steps.push_back(step);
  }
  return map;
}

TEST(LensDistance, CorrectsTheStepsOnceItIsCertain) {
  Map map = SeenThroughLenses(20, 0.005);
  const double ratio = 1.2 / kHeight;
  EXPECT_NEAR(CorrectForLenses({}, &map), ratio / (ratio - kDistance), 1e-9);
  for (KeyframeId id = 1; id < 20; ++id) {
    const GroundStepFrom& step = map.keyframe(id).ground_steps.front();
    EXPECT_NEAR(step.ratio, ratio, 1e-9);
    EXPECT_NEAR(step.assumed_lens_distance, kDistance, 1e-9);
    // Both cameras see the point half-way at the same place.
    EXPECT_NEAR(
        (PoseAt(id - 1) * (kHeight * step.point1) - PoseAt(id) * (kHeight * step.point2)).norm(),
        0.0, 1e-9);
  }
  EXPECT_NEAR(AssumedLensDistance(map), kDistance, 1e-9);
  EXPECT_EQ(CorrectForLenses({}, &map), 1);  // nothing new
}

TEST(LensDistance, ChangesNothingBeforeItIsCertain) {
  Map uncertain = SeenThroughLenses(20, 0.02);
  EXPECT_EQ(CorrectForLenses({}, &uncertain), 1);
  EXPECT_EQ(AssumedLensDistance(uncertain), 0);
  Map few = SeenThroughLenses(8, 0.002);
  EXPECT_EQ(CorrectForLenses({}, &few), 1);
  Map none = SeenThroughLenses(20, 0.0);
  EXPECT_EQ(CorrectForLenses({}, &none), 1);
}

TEST(LensDistance, StepsThatContradictEachOtherAreNotCertain) {
  Map map = SeenThroughLenses(40, 0.002);
  for (KeyframeId id = 2; id < 40; id += 2) {
    map.keyframe(id).ground_steps.front().lens_distance.value = -kDistance / 2;
  }
  EXPECT_FALSE(EstimateLensDistance(std::span(&map, 1)).is_certain);
}

TEST(LensDistance, FinishedMapsTellItToo) {
  const Map finished = SeenThroughLenses(20, 0.005);
  Map map = SeenThroughLenses(3, 0.005);
  EXPECT_EQ(CorrectForLenses({}, &map), 1);
  EXPECT_GT(CorrectForLenses(std::span(&finished, 1), &map), 1.02);
}

TEST(LensDistance, KeyframesOfAnEarlierRunHoldTheUnit) {
  Map map = SeenThroughLenses(20, 0.005);
  map.keyframe(0).frame_index = -1;
  EXPECT_EQ(CorrectForLenses({}, &map), 1);
  EXPECT_NEAR(AssumedLensDistance(map), kDistance, 1e-9);
}

}  // namespace
}  // namespace orb360
