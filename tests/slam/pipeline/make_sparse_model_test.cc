#include "slam/pipeline/make_sparse_model.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(1024, 512);

/// Two maps of three keyframes each and one frame between them, which is no keyframe. Frame indices
/// are 0, 1, 2 and 10, 11, 12; frame 5 belongs to the first map.
struct TwoMaps {
  std::vector<Map> maps;
  Reconstruction reconstruction;
  Rigid3 file_world_from_map{ExpSo3({0.2, -0.1, 0.7}), {3, 2, 1}};

  TwoMaps() {
    for (int m = 0; m < 2; ++m) {
      SyntheticScene scene(30);
      Map& map = maps.emplace_back(scene.MakeMap(Walk(3, {-0.5, 0.1, 0.0}), 20));
      for (const KeyframeId id : map.KeyframeIds()) {
        map.keyframe(id).frame_index += 10 * m;
        const Keyframe& keyframe = map.keyframe(id);
        reconstruction.keyframes.push_back({.index = keyframe.frame_index,
                                            .timestamp = 0.1 * keyframe.frame_index,
                                            .map = m,
                                            .world_from_camera = keyframe.world_from_camera});
      }
    }
    reconstruction.frames = reconstruction.keyframes;
    reconstruction.frames.push_back(
        {.index = 5, .timestamp = 0.5, .map = 0, .world_from_camera = {}});
  }

  SparseModel Make() const {
    return MakeSparseModel(reconstruction, maps, kCamera, file_world_from_map);
  }
};

TEST(MakeSparseModel, EveryAlignedObservationIsWhereItsPointAppears) {
  TwoMaps two;
  for (Map& map : two.maps) {
    for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
      Landmark& landmark = map.landmark(id);
      for (Observation& observation : landmark.observations) {
        const Rigid3 camera_from_world =
            map.keyframe(observation.keyframe).world_from_camera.Inverse();
        observation.aligned_bearing =
            (camera_from_world * landmark.position).normalized().cast<float>();
        observation.aligned_sigma = 0.001f;
      }
    }
  }
  const SparseModel model = two.Make();
  ASSERT_EQ(model.frames.size(), 7u);
  ASSERT_EQ(model.points.size(), 40u);
  for (const PosedFrame& frame : model.frames) {
    EXPECT_EQ(frame.observations.size(), frame.is_keyframe ? 20u : 0u) << frame.index;
    EXPECT_EQ(frame.map, frame.index >= 10 ? 1 : 0);
    for (const PointObservation& observation : frame.observations) {
      EXPECT_EQ(observation.point >= 20, frame.map == 1);
      const Eigen::Vector3d p = frame.world_from_optical.Inverse() *
                                model.points[static_cast<size_t>(observation.point)].position;
      const double u = (std::atan2(p.x(), p.z()) / (2 * std::numbers::pi) + 0.5) * 1024;
      const double v = (0.5 + std::atan2(p.y(), std::hypot(p.x(), p.z())) / std::numbers::pi) * 512;
      EXPECT_NEAR(kCamera.WrapDeltaU(observation.pixel.x() - u), 0.0, 2e-3);
      EXPECT_NEAR(observation.pixel.y(), v, 1e-3);
    }
  }
}

TEST(MakeSparseModel, WithoutAlignmentThePixelIsThatOfTheFeature) {
  TwoMaps two;
  const SparseModel model = two.Make();
  for (const PosedFrame& frame : model.frames) {
    for (const PointObservation& observation : frame.observations) {
      EXPECT_EQ(observation.pixel, Eigen::Vector2f::Zero());  // as the scene sets it
    }
  }
}

TEST(MakeSparseModel, FramesOfTheRunThatMadeALoadedMapAreLeftOutWithWhatOnlyTheyObserve) {
  TwoMaps two;
  Map& map = two.maps[0];
  for (const KeyframeId id : {0, 1}) {  // of an earlier run
    map.keyframe(id).frame_index -= 100;
    two.reconstruction.keyframes[static_cast<size_t>(id)].index -= 100;
    two.reconstruction.frames[static_cast<size_t>(id)].index -= 100;
  }
  map.RemoveObservation(4, 2);  // Only earlier keyframes observe landmark 4 now.
  const SparseModel model = two.Make();
  ASSERT_EQ(model.frames.size(), 5u);
  EXPECT_EQ(model.frames.front().index, 2);
  EXPECT_EQ(model.frames.front().observations.size(), 19u);
  EXPECT_EQ(model.points.size(), 39u);
}

}  // namespace
}  // namespace orb360
