#include <cstring>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/map_arrays.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/pipeline/synthetic_scene.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/map_file.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// With gaps in the ids, as culling leaves them.
StoredMap Stored() {
  SyntheticScene scene(60);
  StoredMap stored{1024,
                   {ExpSo3({0.1, 0.2, 0.3}), {4, 5, 6}},
                   KnownGround{{0.0, 0.6, 0.8}, 1.7},
                   scene.MakeMap(Walk(5, {-0.5, 0.1, 0.0}), 40)};
  stored.map.RemoveKeyframe(1, 2);
  stored.map.RemoveLandmark(7);
  stored.map.landmark(9).visible = 12;
  stored.map.landmark(9).found = 5;
  Observation& aligned = stored.map.landmark(9).observations.back();
  aligned.aligned_bearing = {0.48f, 0.6f, 0.64f};
  aligned.aligned_sigma = 0.0012f;
  return stored;
}

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string Refusal(const std::string& path) {
  try {
    ReadMap(path);
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), StartsWith(path + ": "));
    return error.what();
  }
  return "accepted";
}

template <typename T>
bool SameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(MapFile, ReadsBackExactlyWhatWasWritten) {
  const TempFolder folder;
  const StoredMap stored = Stored();
  WriteMap(folder / "map.h5", stored);
  const StoredMap read = ReadMap(folder / "map.h5");
  read.map.CheckConsistency();
  EXPECT_EQ(read.width, 1024);
  EXPECT_EQ(read.file_world_from_map.translation, stored.file_world_from_map.translation);
  EXPECT_EQ(read.file_world_from_map.rotation.coeffs(),
            stored.file_world_from_map.rotation.coeffs());
  ASSERT_TRUE(read.ground.has_value());
  EXPECT_EQ(read.ground->up, stored.ground->up);
  EXPECT_EQ(read.ground->camera_height, 1.7);
  ASSERT_EQ(read.map.num_keyframes(), 4);
  ASSERT_EQ(read.map.num_landmarks(), 39);
  // Keyframe 1 and landmark 7 have gone; what came after them has moved up.
  const Keyframe& was = stored.map.keyframe(3);
  const Keyframe& is = read.map.keyframe(2);
  EXPECT_EQ(is.frame_index, was.frame_index);
  EXPECT_EQ(is.timestamp, was.timestamp);
  EXPECT_EQ(is.world_from_camera.translation, was.world_from_camera.translation);
  EXPECT_EQ(is.world_from_camera.rotation.coeffs(), was.world_from_camera.rotation.coeffs());
  EXPECT_EQ(is.features->descriptors, was.features->descriptors);
  EXPECT_EQ(is.features->bearings, was.features->bearings);
  EXPECT_EQ(is.features->colors, was.features->colors);
  ASSERT_EQ(is.features->size(), was.features->size());
  for (int f = 0; f < is.features->size(); ++f) {
    EXPECT_EQ(is.features->keypoints[f].pixel, was.features->keypoints[f].pixel);
    EXPECT_EQ(is.features->keypoints[f].sigma, was.features->keypoints[f].sigma);
    EXPECT_EQ(is.features->keypoints[f].level, was.features->keypoints[f].level);
    EXPECT_EQ(is.features->keypoints[f].score, was.features->keypoints[f].score);
    EXPECT_EQ(is.landmarks[f] + (is.landmarks[f] >= 7), was.landmarks[f]);
  }
  const Landmark& seen = read.map.landmark(8);
  EXPECT_EQ(seen.position, stored.map.landmark(9).position);
  EXPECT_EQ(seen.descriptor, stored.map.landmark(9).descriptor);
  EXPECT_EQ(seen.visible, 12);
  EXPECT_EQ(seen.found, 5);
  ASSERT_EQ(seen.observations.size(), 4u);
  EXPECT_EQ(seen.observations[2].aligned_sigma, 0);
  EXPECT_EQ(seen.observations[3].aligned_sigma, 0.0012f);
  EXPECT_EQ(seen.observations[3].aligned_bearing, Eigen::Vector3f(0.48f, 0.6f, 0.64f));
}

TEST(MapFile, TheSameMapGivesTheSameBytesAgain) {
  const TempFolder folder;
  WriteMap(folder / "a.h5", Stored());
  WriteMap(folder / "b.h5", ReadMap(folder / "a.h5"));
  EXPECT_EQ(ReadText(folder / "a.h5"), ReadText(folder / "b.h5"));
}

TEST(MapFile, RefusesWhatIsDamagedOrOfAnotherKindOrVersion) {
  const TempFolder folder;
  WriteMap(folder / "map.h5", Stored());
  const std::string good = ReadText(folder / "map.h5");
  const auto refuse = [&](const std::string& bytes) {
    const std::string path = folder / "bad.h5";
    std::ofstream(path, std::ios::binary) << bytes;
    return Refusal(path);
  };
  std::string bad = good;
  bad[good.size() / 2] ^= 1;
  EXPECT_THAT(refuse(bad), HasSubstr("is damaged"));
  EXPECT_THAT(refuse(good.substr(0, good.size() - 1)), HasSubstr("is damaged"));
  EXPECT_THAT(refuse("a video"), HasSubstr("is not a map of orb360"));
  bad = good;
  bad[8] = 9;
  EXPECT_THAT(refuse(bad), AllOf(HasSubstr("version 9"), HasSubstr("reads version 2")));
  EXPECT_THAT(Refusal(folder / "none.h5"), HasSubstr("cannot be read"));
}

// What stands behind a right digest can still be no map.
TEST(MapArrays, RefusesColumnsThatAreNotAMap) {
  const MapArrays good = ToArrays(Stored().map);
  const auto refuse = [&](const auto& spoil) -> std::string {
    MapArrays bad = good;
    spoil(&bad);
    try {
      FromArrays(bad);
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refuse([](MapArrays*) {}), "accepted");
  EXPECT_THAT(refuse([](MapArrays* a) { a->score.pop_back(); }), HasSubstr("score"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->pose[3] = 2.0; }), HasSubstr("keyframe 0"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->timestamp[1] = NAN; }), HasSubstr("keyframe 1"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->features_end[0] = -1; }), HasSubstr("keyframe 0"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->features_end.back() -= 1; }), HasSubstr("no keyframe"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->feature_landmark[5] = 39; }), HasSubstr("feature 5"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->feature_landmark[5] = a->feature_landmark[6]; }),
              HasSubstr("seen twice"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->level[2] = 8; }), HasSubstr("feature 2"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->aligned_bearing.pop_back(); }), HasSubstr("aligned"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->aligned_sigma[3] = -1; }),
              HasSubstr("alignment of feature 3"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->aligned_sigma[3] = INFINITY; }),
              HasSubstr("alignment of feature 3"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->aligned_bearing[3 * 50] = 1; }),  // sees no landmark
              HasSubstr("alignment of feature 50"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->aligned_sigma[3] = 0.001f; }),  // without a direction
              HasSubstr("alignment of feature 3"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->bearing[3] += 0.1; }), HasSubstr("feature 1"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->max_range[4] = 0.0; }), HasSubstr("landmark 4"));
  EXPECT_THAT(refuse([](MapArrays* a) { a->first_keyframe[4] = 4; }), HasSubstr("landmark 4"));
  EXPECT_THAT(refuse([](MapArrays* a) {
                for (int32_t& id : a->feature_landmark) id = id == 3 ? -1 : id;
              }),
              HasSubstr("landmark 3"));
  EXPECT_THAT(refuse([](MapArrays* a) { *a = MapArrays(); }), HasSubstr("no keyframe"));
}

}  // namespace
}  // namespace orb360
