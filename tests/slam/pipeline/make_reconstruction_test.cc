#include "slam/pipeline/make_reconstruction.h"

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

constexpr int kKeyframes = 8;

// A straight drive past far points, a keyframe each 0.1 s, and one frame half-way between two of
// them, tracked at the wrong place.
struct Drive {
  SyntheticScene scene{200, 4000.0, 8000.0};
  std::vector<Map> maps;
  FrameAnchors anchors;
  Eigen::Vector3d truth{-3.5, 0, 0};

  Drive() {
    std::vector<Rigid3> poses;
    for (int k = 0; k < kKeyframes; ++k) {
      poses.push_back({Eigen::Quaterniond::Identity(), {-1.0 * k, 0, 0}});
    }
    maps.push_back(scene.MakeMap(poses, 200));
    const TrackedFrame frame{.index = 100,
                             .timestamp = 0.35,
                             .features = scene.See({Eigen::Quaterniond::Identity(), truth}),
                             .world_from_camera = {},
                             .landmarks = maps[0].keyframe(3).landmarks};
    anchors[100] = {.timestamp = 0.35,
                    .map = 0,
                    .reference = 3,
                    .reference_from_camera = {Eigen::Quaterniond::Identity(), {0.3, 0.4, 0}},
                    .sightings = SightingsOf(frame)};
  }
};

TEST(MakeReconstruction, AFrameThatSeesOnlyFarPointsLiesOnTheWayBetweenItsKeyframes) {
  const Drive drive;
  const Reconstruction result = MakeReconstruction(drive.maps, drive.anchors, 1);
  ASSERT_EQ(result.frames.size(), 1u);
  EXPECT_LT((result.frames[0].world_from_camera.translation - drive.truth).norm(), 0.02);
}

TEST(MakeReconstruction, CountsFramesThatWereInterpolated) {
  Drive drive;
  EXPECT_EQ(MakeReconstruction(drive.maps, drive.anchors, 1).interpolated, 0);
  drive.anchors[100].is_interpolated = true;
  EXPECT_EQ(MakeReconstruction(drive.maps, drive.anchors, 1).interpolated, 1);
}

}  // namespace
}  // namespace orb360
