#include "apps/town/drive/track.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

constexpr Footprint kCar{4.5, 1.85};
constexpr Footprint kBicycle{1.75, 0.56};
constexpr Moments kMoments{0, 30};

const Lap& LapOfSpeed(double speed) {
  static const StreetPlan plan = PlanStreets({.seed = 4});
  static const Lap slow(plan, plan.tour,
                        {.minimum_speed = 4, .maximum_speed = 4, .stop_fraction = 0});
  static const Lap fast(plan, plan.tour,
                        {.minimum_speed = 8, .maximum_speed = 8, .stop_fraction = 0});
  return speed < 5 ? slow : fast;
}

TEST(Track, DiscsCoverTheOutline) {
  for (const Footprint& size : {kCar, kBicycle, Footprint{5.2, 2}, Footprint{11, 2.5}}) {
    const Track track = TrackOf(Ride{.lap = &LapOfSpeed(8)}, size, {0, 0});
    for (double ratio = -1; ratio <= 1; ratio += 0.05) {
      for (const Vector2d& p : {Vector2d(ratio * 0.5 * size.length, 0.5 * size.width),
                                Vector2d(0.5 * size.length, ratio * 0.5 * size.width)}) {
        bool is_covered = false;
        for (const double disc : track.discs)
          is_covered |= (p - Vector2d(disc, 0)).norm() < track.radius + 1e-9;
        EXPECT_TRUE(is_covered) << size.length << " m: " << p.transpose();
      }
    }
  }
}

TEST(FirstMeeting, IsWhereTwoTracksTouch) {
  const auto still = [](double x) {
    return TrackOf([x](double) { return Vector2d(x, 0); }, 0.5, kMoments);
  };
  const Track walking = TrackOf([](double time) { return Vector2d(time, 0); }, 0.5, kMoments);
  EXPECT_FALSE(FirstMeeting(still(0), still(1.01), 0, kMoments.Count()));
  EXPECT_EQ(FirstMeeting(still(0), still(0.99), 3, kMoments.Count()), 3);
  EXPECT_NEAR(FirstMeeting(walking, still(5), 0, kMoments.Count()).value(), 41, 1);
  EXPECT_FALSE(FirstMeeting(walking, still(5), 0, 30));
}

TEST(FindPasses, PassesASlowerOneWithoutMeetingIt) {
  Ride slow{.lap = &LapOfSpeed(4), .from_kerb = 0.6};
  Ride fast{.lap = &LapOfSpeed(8)};
  fast.ahead = fast.lap->TimeAt(slow.DistanceAt(12)) - 12;  // beside it after 12 seconds
  const Track cyclist = TrackOf(slow, kBicycle, kMoments);
  EXPECT_LT(fast.DistanceAt(6), slow.DistanceAt(6));
  EXPECT_GT(fast.DistanceAt(18), slow.DistanceAt(18));
  ASSERT_TRUE(Meet(TrackOf(fast, kCar, kMoments), cyclist));
  fast.passes = FindPasses(fast, kCar, {&cyclist}, kMoments).value();
  EXPECT_EQ(fast.passes.size(), 1U);
  EXPECT_FALSE(Meet(TrackOf(fast, kCar, kMoments), cyclist));
}

TEST(FindPasses, HeedsNobodyWhoComesFromBehind) {
  Ride slow{.lap = &LapOfSpeed(4)};
  Ride fast{.lap = &LapOfSpeed(8)};
  fast.ahead = fast.lap->TimeAt(slow.DistanceAt(12)) - 12;
  const Track behind = TrackOf(fast, kCar, kMoments);
  EXPECT_TRUE(FindPasses(slow, kCar, {&behind}, kMoments).value().empty());
}

}  // namespace
}  // namespace orb360::town
