#include "slam/pipeline/back_end.h"

#include <utility>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

Map SmallMap() {
  SyntheticScene scene(200);
  return scene.MakeMap(Walk(4, {-0.5, 0.1, 0.0}), 150);
}

KeyframeMapping MappingOf(Map map) {
  return {.active = {std::move(map), LoopDetector({}, {}, 12, 0.001)},
          .finished = {},
          .frame = {},
          .pyramid = nullptr,
          .ground = {}};
}

TEST(BackEnd, AdjustsACopyOfTheMapWhileAJobHasTheMap) {
  BackEnd back_end((Options()));
  const Map map = SmallMap();
  EXPECT_FALSE(back_end.is_adjusting());
  back_end.Start(GlobalAdjustment{.map = map, .ground = {}}, {.num_frames = 5});
  KeyframeMapping mapping = MappingOf(map);
  mapping.frame = MakeTracked(map.keyframe(3));
  mapping.frame.index = 100;
  back_end.Start(MapJob(std::move(mapping)), {.num_frames = 3});
  EXPECT_TRUE(back_end.is_adjusting());
  EXPECT_TRUE(back_end.has_map());
  EXPECT_FALSE(back_end.IsMapDue(2, 1000));
  EXPECT_TRUE(back_end.IsMapDue(3, 1000));
  EXPECT_FALSE(back_end.IsAdjustmentDue(4));
  EXPECT_TRUE(back_end.IsAdjustmentDue(5));

  const MappedKeyframe mapped = std::get<MappedKeyframe>(back_end.TakeMap());
  EXPECT_EQ(mapped.update.reference, 4);
  EXPECT_EQ(mapped.active.map.keyframe(4).frame_index, 100);
  const AdjustedMap adjusted = back_end.TakeAdjusted();
  EXPECT_EQ(adjusted.before.keyframe(3).world_from_camera.translation,
            map.keyframe(3).world_from_camera.translation);
  EXPECT_NE(adjusted.after.keyframe(3).world_from_camera.translation,
            map.keyframe(3).world_from_camera.translation);
  EXPECT_FALSE(back_end.is_adjusting());
  EXPECT_FALSE(back_end.has_map());
}

TEST(BackEnd, AJobThatThrowsEndsTheOtherOneAsWell) {
  BackEnd back_end((Options()));
  const Map map = SmallMap();
  back_end.Start(GlobalAdjustment{.map = map, .ground = {}}, {});
  KeyframeMapping broken = MappingOf(map);
  broken.frame = MakeTracked(map.keyframe(3));
  broken.frame.landmarks[0] = map.landmark_end();  // there is no such landmark
  back_end.Start(MapJob(std::move(broken)), {});
  EXPECT_THROW(back_end.TakeMap(), ContractError);
  EXPECT_FALSE(back_end.has_map());
  EXPECT_FALSE(back_end.is_adjusting());
}

}  // namespace
}  // namespace orb360
