#include "slam/pipeline/loop_detector.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/ring_street.h"

namespace orb360 {
namespace {

constexpr int kLap = 90;  // keyframes, 2.1 m apart
constexpr int kLocalKeyframes = 12;

double ArcOf(int keyframe) { return 2.0 * std::numbers::pi * keyframe / kLap; }

LoopDetector MakeDetector() { return LoopDetector({}, {}, kLocalKeyframes, RingStreet::kSigma); }

// 6 % of scale, 5 degrees and 1 % of height a lap.
Similarity3 Drift() {
  return {std::exp(0.06 / kLap), ExpSo3({0, 0, 0.09 / kLap}), {0, 0, 1.9 / kLap}};
}

TEST(LoopDetector, FindsTheLoopAndWhatHasDrifted) {
  RingStreet street(2000);
  RingStreet::Drive drive;
  LoopDetector detector = MakeDetector();
  std::optional<Loop> loop;
  int found_at = 0;
  for (int k = 0; k < kLap + 15 && !loop; ++k) {
    const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k)), Drift(), &drive);
    loop = detector.Observe(drive.map, id, {});
    found_at = k;
  }
  ASSERT_TRUE(loop.has_value());
  EXPECT_GT(found_at, kLap - 8);  // nothing can be seen again before
  EXPECT_FALSE(loop->finished_map.has_value());
  ASSERT_GE(loop->revisits.size(), 3u);
  for (const Revisit& revisit : loop->revisits) {
    const Rigid3& here = drive.truth[revisit.keyframe];
    const Rigid3& there = drive.truth[revisit.place];
    EXPECT_LT((here.translation - there.translation).norm(), RingStreet::kSight);
    // The truth of the relation, in the scale that the map has at the place.
    const Rigid3 truth = there.Inverse() * here;
    EXPECT_LT(revisit.place_from_keyframe.rotation.angularDistance(truth.rotation), 0.02);
    EXPECT_LT((revisit.place_from_keyframe.translation - truth.translation).norm(), 0.15);
    EXPECT_NEAR(revisit.place_from_keyframe.scale, std::exp(-0.06), 0.02);
  }
}

TEST(LoopDetector, FindsTheLoopWhereTheScaleHasDriftedByAFactorOfThree) {
  for (const double drift : {std::log(3.0), -std::log(3.0)}) {
    RingStreet street(2000);
    RingStreet::Drive drive;
    LoopDetector detector = MakeDetector();
    std::optional<Loop> loop;
    for (int k = 0; k < kLap + 15 && !loop; ++k) {
      const Similarity3 step{std::exp(drift / kLap), Eigen::Quaterniond::Identity(), {0, 0, 0}};
      const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k)), step, &drive);
      loop = detector.Observe(drive.map, id, {});
    }
    ASSERT_TRUE(loop.has_value()) << drift;
    for (const Revisit& revisit : loop->revisits) {
      EXPECT_LT((drive.truth[revisit.keyframe].translation - drive.truth[revisit.place].translation)
                    .norm(),
                RingStreet::kSight);
      EXPECT_NEAR(std::log(revisit.place_from_keyframe.scale), -drift, 0.1);
    }
  }
}

// On the second lap, the places on the first one that are far enough back lie behind the camera.
TEST(LoopDetector, ALoopIsNoShorterThanAsked) {
  RingStreet street(2000);
  RingStreet::Drive drive;
  LoopOptions options;
  options.min_length = 22;  // median ranges: a lap and a few keyframes
  LoopDetector detector(options, {}, kLocalKeyframes, RingStreet::kSigma);
  std::optional<Loop> loop;
  std::vector<double> asked;  // metres, by keyframe
  for (int k = 0; k < kLap + 15 && !loop; ++k) {
    const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &drive);
    asked.push_back(options.min_length * drive.map.MedianRange(id));
    loop = detector.Observe(drive.map, id, {});
  }
  ASSERT_TRUE(loop.has_value());
  for (const Revisit& revisit : loop->revisits) {
    double way = 0;
    for (KeyframeId id = revisit.place; id < revisit.keyframe; ++id) {
      way += (drive.truth[id + 1].translation - drive.truth[id].translation).norm();
    }
    EXPECT_GE(way, asked[revisit.keyframe]);
  }
}

// The way back is in the opposite direction and on the other side of the street.
TEST(LoopDetector, RecognisesAStreetDrivenTheOtherWay) {
  RingStreet street(2000);
  RingStreet::Drive drive;
  LoopDetector detector = MakeDetector();
  for (int k = 0; k < 40; ++k) {
    const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &drive);
    EXPECT_FALSE(detector.Observe(drive.map, id, {}).has_value()) << k;
  }
  // Somewhere else for a while: nothing there is known, and the way is long.
  drive.last = {};
  drive.landmark_of_point.clear();
  std::optional<Loop> loop;
  for (int k = 16; k > 0 && !loop; --k) {
    const Rigid3 pose = RingStreet::PoseAt(ArcOf(k), 2.0, std::numbers::pi);
    loop = detector.Observe(drive.map, street.DriveOn(pose, {}, &drive), {});
  }
  ASSERT_TRUE(loop.has_value());
  for (const Revisit& revisit : loop->revisits) {
    const auto distance = [&](KeyframeId place) {
      return (drive.truth[revisit.keyframe].translation - drive.truth[place].translation).norm();
    };
    EXPECT_LT(distance(revisit.place), RingStreet::kSight);
    // None of those of the way there is nearer.
    for (KeyframeId place = 0; place < 40; ++place) {
      EXPECT_LT(distance(revisit.place), distance(place) + 0.2) << place;
    }
  }
}

// Both halves of the ring show exactly the same. Images cannot tell them apart; that the map
// would have to be off by the size of the block can.
TEST(LoopDetector, IsNotDeceivedByAStreetThatLooksTheSame) {
  RingStreet street(2000, 2);
  RingStreet::Drive drive;
  LoopDetector detector = MakeDetector();
  for (int k = 0; k < kLap - 12; ++k) {
    const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k)), Drift(), &drive);
    EXPECT_FALSE(detector.Observe(drive.map, id, {}).has_value()) << k;
  }
}

TEST(LoopDetector, DoesNotTakeASharedFacadeForTheSamePlace) {
  // Two streets that have every sixth point in common, as if the same house stood in both.
  RingStreet street(2000);
  RingStreet::Drive first;
  LoopDetector detector = MakeDetector();
  for (int k = 0; k < 12; ++k) {
    detector.Observe(first.map, street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &first), {});
  }
  const std::vector<Map> finished = {first.map};
  RingStreet::Drive second;
  for (int k = 0; k < 12; ++k) {
    const Rigid3 pose = RingStreet::PoseAt(ArcOf(k));
    const KeyframeId id = street.DriveOn(pose, {}, &second);
    auto other = std::make_shared<Features>(*second.map.keyframe(id).features);
    for (int f = 0; f < other->size(); ++f) {
      if (second.last.points[f] % 6 != 0) {
        for (uint64_t& word : other->descriptors[f]) word = ~word * 0x9e3779b97f4a7c15u;
      }
    }
    second.map.keyframe(id).features = other;
    EXPECT_FALSE(detector.Observe(second.map, id, finished).has_value()) << k;
  }
}

TEST(LoopDetector, FindsThatAnotherMapShowsTheSame) {
  RingStreet street(2000);
  RingStreet::Drive first;
  LoopDetector detector = MakeDetector();
  for (int k = 0; k < 30; ++k) {
    detector.Observe(first.map, street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &first), {});
  }
  const std::vector<Map> finished = {first.map};
  // The second map has a world of its own, half as large.
  RingStreet::Drive second;
  second.drift = {0.5, ExpSo3({0.1, 0.2, 1.0}), {7, 8, 9}};
  std::optional<Loop> loop;
  for (int k = 10; k < 25 && !loop; ++k) {
    const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k), 0.5, 2.0), {}, &second);
    loop = detector.Observe(second.map, id, finished);
  }
  ASSERT_TRUE(loop.has_value());
  EXPECT_EQ(loop->finished_map, 0);
  const Similarity3 back = CorrectionBy(loop->revisits.back(), second.map, first.map);
  EXPECT_NEAR(back.scale, 2.0, 0.04);
  for (size_t k = 0; k < second.truth.size(); ++k) {
    const Eigen::Vector3d found =
        back * second.map.keyframe(static_cast<KeyframeId>(k)).world_from_camera.translation;
    EXPECT_LT((found - second.truth[k].translation).norm(), 0.3);
  }
}

TEST(LoopDetector, FindsALostCameraWhateverWayItIsHeld) {
  RingStreet street(2000);
  RingStreet::Drive drive;
  LoopDetector detector = MakeDetector();
  for (int k = 0; k < 60; ++k) {
    detector.Observe(drive.map, street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &drive), {});
  }
  RandomGeometry random(5);
  for (int i = 0; i < 10; ++i) {
    Rigid3 pose = RingStreet::PoseAt(ArcOf(5) + random.Uniform(0.0, 3.0), 1.0);
    pose.rotation = random.Rotation();
    const RingStreet::View view = street.See(pose);
    const auto found = detector.FindPose(*view.features, drive.map, {});
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->map, 0);
    EXPECT_LT((found->result.world_from_camera.translation - pose.translation).norm(), 0.05);
    EXPECT_LT(found->result.world_from_camera.rotation.angularDistance(pose.rotation), 0.01);
  }
  // On the part of the ring where the drive never was.
  const RingStreet::View unknown = street.See(RingStreet::PoseAt(ArcOf(75)));
  EXPECT_FALSE(detector.FindPose(*unknown.features, drive.map, {}).has_value());
}

TEST(LoopDetector, FollowsTheNumbersOfMaps) {
  RingStreet street(2000);
  RingStreet::Drive drive;
  LoopDetector detector = MakeDetector();
  for (int k = 0; k < 30; ++k) {
    detector.Observe(drive.map, street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &drive), {});
  }
  // The map comes behind an empty one, and its keyframes behind one of another map.
  Map shifted;
  shifted.AddKeyframe(-1, 0.0, {}, std::make_shared<Features>());
  shifted.Append(drive.map);
  detector.Renumber(std::vector<int>{1}, 0, 1);
  const RingStreet::View view = street.See(RingStreet::PoseAt(ArcOf(15)));
  const std::vector<Map> finished = {Map()};
  const auto found = detector.FindPose(*view.features, shifted, finished);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->map, 1);
  EXPECT_NEAR(found->local.reference, 16, 2);
}

}  // namespace
}  // namespace orb360
