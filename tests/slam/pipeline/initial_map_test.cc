#include "slam/pipeline/initial_map.h"

#include <memory>

#include <gtest/gtest.h>

#include "slam/features/sphere_pyramid.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

TEST(InitialMap, HasTheImagesOfBothFramesToMeasureTheStepBetweenThem) {
  SyntheticScene scene(120);
  const Rigid3 second{Eigen::Quaterniond::Identity(), {-0.5, 0.1, 0.0}};
  const auto frame = [&](int index, const Rigid3& pose) {
    return PendingFrame{.index = index,
                        .timestamp = 0.1 * index,
                        .features = scene.See(pose),
                        .image = std::make_shared<const SpherePyramid>()};
  };
  const PendingFrame frame1 = frame(3, Rigid3());
  const PendingFrame frame2 = frame(5, second);
  TwoViewMap views{.world_from_camera2 = second, .points = {}};
  for (int i = 0; i < 120; ++i) views.points.push_back({i, i, scene.points[i].position});
  const InitialMap initial = MakeInitialMap(frame1, frame2, views, {});
  EXPECT_EQ(initial.map.keyframe(InitialMap::kFirst).image, frame1.image);
  EXPECT_EQ(initial.map.keyframe(InitialMap::kSecond).image, frame2.image);
  EXPECT_EQ(initial.map.keyframe(InitialMap::kFirst).frame_index, 3);
}

}  // namespace
}  // namespace orb360
