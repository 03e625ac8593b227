#include "apps/town/drive/ride.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

const Lap& TestLap() {
  static const StreetPlan plan = PlanStreets({.seed = 4});
  static const Lap lap(plan, plan.tour, {.seed = 1});
  return lap;
}

TEST(Ride, WithoutPassesAndDelaysFollowsTheLap) {
  const Ride ride{.lap = &TestLap(), .ahead = 3};
  for (double time = 0; time < 40; time += 1.7) {
    const Lap::State state = TestLap().At(time + 3);
    EXPECT_NEAR((ride.PoseAt(time).position - TestLap().PoseAt(state.station).position).norm(), 0,
                1e-9);
    EXPECT_EQ(ride.SpeedAt(time), state.speed);
  }
}

TEST(Ride, SwervesSmoothlyAndComesBackToItsLine) {
  const Ride ride{.lap = &TestLap(), .passes = {{60, 80, 2.5}}};
  EXPECT_EQ(ride.LeftAt(30), 0);
  EXPECT_EQ(ride.LeftAt(70), 2.5);
  EXPECT_EQ(ride.LeftAt(120), 0);
  for (double s = 30; s < 120; s += 0.5)
    EXPECT_LT(std::abs(ride.LeftAt(s + 0.5) - ride.LeftAt(s)), 0.15) << s;
}

TEST(Ride, PassesOnTheLeft) {
  const Ride ride{.lap = &TestLap(), .passes = {{0, 500, 1.5}}};
  for (double time = 0; time < 40; time += 1.7) {
    const RoadPose on_line = TestLap().PoseAt(TestLap().At(time).station);
    const Vector2d aside = ride.PoseAt(time).position - on_line.position;
    EXPECT_NEAR(aside.norm(), 1.5, 1e-6);
    EXPECT_GT(on_line.forward.x() * aside.y() - on_line.forward.y() * aside.x(), 1.4);
  }
}

TEST(Ride, ADelayLosesItsTimeWithoutDrivingBackwards) {
  const Ride free{.lap = &TestLap()};
  const Ride delayed{.lap = &TestLap(), .delays = {{10, 10 + 1.55 * 4 + 2.5, 4}}};
  EXPECT_EQ(delayed.DistanceAt(9), free.DistanceAt(9));
  EXPECT_NEAR(delayed.DistanceAt(25), free.DistanceAt(21), 1e-9);
  constexpr double kStep = 0.01;
  for (double time = 8; time < 22; time += 0.1) {
    const double advance = delayed.DistanceAt(time + kStep) - delayed.DistanceAt(time);
    EXPECT_GE(advance, 0) << time;
    EXPECT_NEAR(advance / kStep, delayed.SpeedAt(time + 0.5 * kStep), 0.05) << time;
  }
}

TEST(Ride, KeepsItsDistanceFromTheKerb) {
  const Ride ride{.lap = &TestLap(), .from_kerb = 0.6};
  for (double s = 0; s < TestLap().length(); s += 3)
    EXPECT_NEAR(TestLap().RoomOnRight(s) + ride.LeftAt(s), 0.6, 1e-9) << s;
}

}  // namespace
}  // namespace orb360::town
