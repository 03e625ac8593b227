#include "slam/viewer/live_landmarks.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/byte_number.h"

namespace orb360 {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::shared_ptr<const Features> SomeFeatures(int count) {
  auto features = std::make_shared<Features>();
  features->keypoints.resize(count);
  features->bearings.assign(count, -Eigen::Vector3d::UnitX());
  features->descriptors.resize(count);
  for (int i = 0; i < count; ++i) features->corners.push_back(i);
  return features;
}

/// Three keyframes along a street; each of the first two observes two landmarks first, which the
/// next one observes as well.
class GroupLandmarksTest : public testing::Test {
 protected:
  GroupLandmarksTest() {
    for (int i = 0; i < 3; ++i) {
      Rigid3 pose;
      pose.translation = {-2.0 * i, 0, 0};
      map_.AddKeyframe(i, i, pose, SomeFeatures(4));
    }
    for (int i = 0; i < 4; ++i) {
      const LandmarkId id = map_.AddLandmark({-10.0 - i, 1.0, 0.5}, {10, 20, 30});
      map_.AddObservation(id, i / 2, i);
      map_.AddObservation(id, i / 2 + 1, i);
    }
  }

  LandmarkGroups Group(int revision, const LandmarkGroups& before = {}) const {
    return GroupLandmarks({&map_, 1}, revision, before);
  }

  /// Keyframes whose landmarks a page gets that has all up to a revision.
  static std::vector<int> Sent(const LandmarkGroups& groups, std::uint64_t since) {
    const std::string bytes = LivePoints(groups, 9, since);
    EXPECT_EQ(ReadNumber<std::uint32_t>(bytes, 0, std::endian::little), 9U);
    std::vector<int> keyframes;
    size_t at = 8;
    for (auto i = *ReadNumber<std::uint32_t>(bytes, 4, std::endian::little); i > 0; --i) {
      keyframes.push_back(*ReadNumber<std::int32_t>(bytes, at, std::endian::little));
      at += 8 + 16 * *ReadNumber<std::uint32_t>(bytes, at + 4, std::endian::little);
    }
    EXPECT_EQ(at, bytes.size());
    return keyframes;
  }

  Map map_;
};

TEST_F(GroupLandmarksTest, LandmarksAreInTheFrameOfTheKeyframeThatObservesThemFirst) {
  const LandmarkGroups groups = Group(1);
  ASSERT_EQ(groups.size(), 2U);
  ASSERT_EQ(groups.at(1).points->size(), 2U);
  EXPECT_EQ(groups.at(1).points->front().position, Eigen::Vector3f(-10, 1, 0.5));
  EXPECT_EQ(CountLandmarks(groups), 4U);
  const std::string bytes = LivePoints(groups, 1, 0);
  // Right, down, forward of the first landmark of keyframe 0, 10 units ahead.
  EXPECT_EQ(ReadNumber<std::int32_t>(bytes, 8, std::endian::little), 0);
  EXPECT_EQ(ReadNumber<float>(bytes, 16, std::endian::little), 1.0f);
  EXPECT_EQ(ReadNumber<float>(bytes, 20, std::endian::little), -0.5f);
  EXPECT_EQ(ReadNumber<float>(bytes, 24, std::endian::little), 10.0f);
  EXPECT_EQ(bytes.substr(28, 4), std::string("\x0a\x14\x1e\0", 4));
}

TEST_F(GroupLandmarksTest, ACorrectionThatMovesLandmarksWithTheirKeyframesSendsNone) {
  const LandmarkGroups before = Group(1);
  const Rigid3 correction{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized())),
      {30, -4, 1}};
  for (const KeyframeId id : map_.KeyframeIds()) {
    map_.keyframe(id).world_from_camera = correction * map_.keyframe(id).world_from_camera;
  }
  for (LandmarkId id = 0; id < map_.landmark_end(); ++id) {
    map_.landmark(id).position = correction * map_.landmark(id).position;
  }
  const LandmarkGroups after = Group(2, before);
  EXPECT_THAT(Sent(after, 1), IsEmpty());
  EXPECT_THAT(Sent(after, 0), ElementsAre(0, 1)) << "a page that is new gets all";
}

TEST_F(GroupLandmarksTest, SendsThoseOfAKeyframeWhereOneMovesAppearsOrVanishes) {
  LandmarkGroups groups = Group(1);
  map_.landmark(3).position.x() -= 0.01;  // a thousandth of its range
  groups = Group(2, groups);
  EXPECT_THAT(Sent(groups, 1), IsEmpty());
  map_.landmark(3).position.x() -= 0.06;
  groups = Group(3, groups);
  EXPECT_THAT(Sent(groups, 2), ElementsAre(1)) << "small steps add up";
  map_.RemoveLandmark(0);
  groups = Group(4, groups);
  EXPECT_THAT(Sent(groups, 3), ElementsAre(0));
  map_.RemoveLandmark(1);
  groups = Group(5, groups);
  EXPECT_THAT(Sent(groups, 4), ElementsAre(0)) << "a page has to remove the last landmark";
  EXPECT_THAT(Sent(Group(6, groups), 5), IsEmpty());
  const LandmarkId added = map_.AddLandmark({-10, 2, 2}, {});
  map_.AddObservation(added, 0, 0);
  EXPECT_THAT(Sent(Group(6, groups), 5), IsEmpty()) << "one keyframe alone observes it";
  map_.AddObservation(added, 1, 0);
  EXPECT_THAT(Sent(Group(6, groups), 5), ElementsAre(0));
}

TEST_F(GroupLandmarksTest, KeyframesOfSeveralMapsHaveIdsOfTheirOwn) {
  const std::vector<Map> maps = {map_, map_};
  const LandmarkGroups groups = GroupLandmarks(maps, 1, {});
  EXPECT_THAT(Sent(groups, 0), ElementsAre(0, 1, 3, 4));
}

}  // namespace
}  // namespace orb360
