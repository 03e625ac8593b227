#include "slam/pipeline/atlas.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kPixelSigma = 0.001;  // rad

Map SmallMap(int num_keyframes) {
  SyntheticScene scene(40);
  return scene.MakeMap(Walk(num_keyframes, {-0.5, 0.1, 0.0}), 30);
}

Atlas EmptyAtlas() { return Atlas(LoopDetector({}, {}, 12, kPixelSigma)); }

FrameAnchor AnchorAt(int map, KeyframeId reference, const Eigen::Vector3d& position) {
  return {.timestamp = 0,
          .map = map,
          .reference = reference,
          .reference_from_camera = {Eigen::Quaterniond::Identity(), position}};
}

/// Where an anchored frame is in the world of its map.
Eigen::Vector3d PositionOf(const Atlas& atlas, int frame_index) {
  const FrameAnchor& anchor = atlas.anchors().at(frame_index);
  return atlas.maps()[anchor.map].PoseOf(anchor.reference) *
         anchor.reference_from_camera.translation;
}

TEST(Atlas, BeginsWithAnEmptyMapAndDropsItInTheEnd) {
  Atlas atlas = EmptyAtlas();
  EXPECT_EQ(atlas.present_number(), 0);
  EXPECT_EQ(atlas.map().num_keyframes(), 0);
  atlas.Finish();
  EXPECT_TRUE(atlas.maps().empty());
}

TEST(Atlas, AnAnchoredFrameFollowsARescaledMap) {
  Atlas atlas = EmptyAtlas();
  atlas.Begin(SmallMap(4));
  atlas.Anchor(7, AnchorAt(0, 2, {0.1, 0.2, 0.3}));
  const Eigen::Vector3d center = atlas.map().PoseOf(0).translation;
  const Eigen::Vector3d before = PositionOf(atlas, 7);
  atlas.Apply(RescaleMap(2.5, 2, &atlas.map()));
  // Everything moves away from the first keyframe, the frame as well as the keyframes.
  EXPECT_LT((PositionOf(atlas, 7) - (center + 2.5 * (before - center))).norm(), 1e-12);
  EXPECT_EQ(atlas.anchors().at(7).unit_scale, 2.5);
}

TEST(Atlas, AFinishedMapChangesItsUnitWithItsFrames) {
  Atlas atlas = EmptyAtlas();
  atlas.Begin(SmallMap(4));
  atlas.Anchor(7, AnchorAt(0, 2, {0.1, 0.2, 0.3}));
  atlas.Begin(SmallMap(3));
  atlas.Anchor(9, AnchorAt(1, 1, {0.3, 0.2, 0.1}));
  const Eigen::Vector3d center = atlas.maps()[0].PoseOf(0).translation;
  const Eigen::Vector3d before = PositionOf(atlas, 7);
  const Eigen::Vector3d other = PositionOf(atlas, 9);
  atlas.ChangeUnit(0, 0.5);
  EXPECT_LT((PositionOf(atlas, 7) - (center + 0.5 * (before - center))).norm(), 1e-12);
  EXPECT_EQ(atlas.anchors().at(7).unit_scale, 0.5);
  EXPECT_EQ(PositionOf(atlas, 9), other);
  EXPECT_EQ(atlas.anchors().at(9).unit_scale, 1.0);
}

TEST(Atlas, AFrameOfAFinishedMapStaysWhenThePresentOneIsRescaled) {
  Atlas atlas = EmptyAtlas();
  atlas.Begin(SmallMap(4));
  atlas.Anchor(7, AnchorAt(0, 2, {0.1, 0.2, 0.3}));
  atlas.Begin(SmallMap(3));
  ASSERT_EQ(atlas.present_number(), 1);
  const Eigen::Vector3d before = PositionOf(atlas, 7);
  atlas.Apply(RescaleMap(2.5, 2, &atlas.map()));
  EXPECT_EQ(PositionOf(atlas, 7), before);
  EXPECT_EQ(atlas.anchors().at(7).unit_scale, 1.0);
}

TEST(Atlas, FramesFollowTheirMapWhenAnotherBecomesThePresentOne) {
  Atlas atlas = EmptyAtlas();
  atlas.Begin(SmallMap(4));
  atlas.SetGround(KnownGround{.up = {0, 0, 1}, .camera_height = 1.5});
  atlas.Anchor(1, AnchorAt(0, 3, {0.1, 0.0, 0.0}));
  atlas.Begin(SmallMap(3));
  atlas.Anchor(2, AnchorAt(1, 2, {0.0, 0.1, 0.0}));
  EXPECT_FALSE(atlas.ground().has_value());
  const Eigen::Vector3d first = PositionOf(atlas, 1);
  const Eigen::Vector3d second = PositionOf(atlas, 2);

  const MapUpdate update = atlas.SwitchTo(0, 3);
  atlas.Apply(update);
  EXPECT_EQ(update.reference, 3);
  EXPECT_EQ(atlas.map().num_keyframes(), 4);
  EXPECT_EQ(atlas.finished().front().num_keyframes(), 3);
  EXPECT_TRUE(atlas.ground().has_value());
  EXPECT_EQ(atlas.anchors().at(1).map, 1);
  EXPECT_EQ(atlas.anchors().at(2).map, 0);
  EXPECT_EQ(PositionOf(atlas, 1), first);
  EXPECT_EQ(PositionOf(atlas, 2), second);
}

TEST(Atlas, AMergedMapDisappearsAndItsFramesBelongToTheOther) {
  Atlas atlas = EmptyAtlas();
  for (const int size : {4, 2, 3}) atlas.Begin(SmallMap(size));
  atlas.Anchor(1, AnchorAt(0, 1, {0.1, 0.0, 0.0}));  // of the map that is merged
  atlas.Anchor(2, AnchorAt(1, 1, {0.2, 0.0, 0.0}));
  atlas.Anchor(3, AnchorAt(2, 1, {0.3, 0.0, 0.0}));  // of the present one

  ActiveMap active = atlas.Lend();
  EXPECT_TRUE(atlas.is_lent());
  EXPECT_THROW(atlas.map(), ContractError);
  Map merged = atlas.finished()[0];
  const KeyframeId shift = merged.keyframe_end();
  const int present_size = active.map.num_keyframes();
  MapUpdate update{.reference = shift};
  update.correction.scale = 2.0;
  update.corrections.assign(active.map.keyframe_end(), update.correction);
  update.renumbering = MapRenumbering{
      .number_of = {1, 0, 1}, .shifted = 2, .keyframe_shift = shift, .landmark_shift = 30};
  active.map.Transform(update.correction);
  merged.Append(active.map);
  active.map = std::move(merged);
  atlas.Return(std::move(active));
  atlas.Apply(update);

  ASSERT_EQ(atlas.maps().size(), 2u);
  EXPECT_EQ(atlas.map().num_keyframes(), 4 + present_size);
  EXPECT_EQ(atlas.anchors().at(1).map, 1);
  EXPECT_EQ(atlas.anchors().at(1).reference, 1);
  EXPECT_EQ(atlas.anchors().at(1).reference_from_camera.translation.x(), 0.1);
  EXPECT_EQ(atlas.anchors().at(2).map, 0);
  EXPECT_EQ(atlas.anchors().at(3).map, 1);
  EXPECT_EQ(atlas.anchors().at(3).reference, 1 + shift);
  EXPECT_EQ(atlas.anchors().at(3).reference_from_camera.translation.x(), 0.6);
}

TEST(Atlas, AFoundLoopIsMeasuredInTheUnitOfTheChangedMap) {
  Atlas atlas = EmptyAtlas();
  atlas.Begin(SmallMap(4));
  Loop loop;
  loop.revisits.push_back({.keyframe = 3,
                           .place = 0,
                           .place_from_keyframe = {1.5, Eigen::Quaterniond::Identity(), {1, 2, 3}},
                           .shared = 50});
  atlas.found_loop = loop;
  MapUpdate update{.reference = 3, .corrections = std::vector<Similarity3>(4)};
  update.corrections[0].scale = 2.0;  // around the place
  update.corrections[3].scale = 4.0;  // around the keyframe
  atlas.Apply(update);
  const Similarity3& moved = atlas.found_loop->revisits[0].place_from_keyframe;
  EXPECT_EQ(moved.scale, 0.75);
  EXPECT_EQ(moved.translation, Eigen::Vector3d(2, 4, 6));
}

TEST(Atlas, WhatAJobHasLostIsDroppedWithItsFrames) {
  Atlas atlas = EmptyAtlas();
  atlas.Begin(SmallMap(4));
  atlas.Anchor(1, AnchorAt(0, 1, Eigen::Vector3d::Zero()));
  atlas.Begin(SmallMap(3));
  atlas.Anchor(2, AnchorAt(1, 1, Eigen::Vector3d::Zero()));
  atlas.Lend();
  atlas.Finish();
  EXPECT_EQ(atlas.maps().size(), 1u);
  EXPECT_TRUE(atlas.anchors().contains(1));
  EXPECT_FALSE(atlas.anchors().contains(2));
}

}  // namespace
}  // namespace orb360
