#include "apps/town/sequence/named_town.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "apps/town/sequence/statistics.h"
#include "apps/town/sequence/town_drive.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

TEST(FindTown, TrainingTownsCanNeverBeEvaluationTowns) {
  const uint64_t largest = FindTown("999999999999999999").seed;
  std::set<uint64_t> seeds;
  for (const char* name : {"Town1", "Town2", "Town3", "Town4", "Town5"}) {
    EXPECT_GT(FindTown(name).seed, largest);
    seeds.insert(FindTown(name).seed);
  }
  EXPECT_EQ(seeds.size(), 5U);
}

TEST(FindTown, EvaluationTownsHaveThePapersLengthsAndLight) {
  EXPECT_EQ(FindTown("Town1").frames, 1000);
  EXPECT_EQ(FindTown("Town3").frames, 2850);
  EXPECT_EQ(FindTown("Town3").light, "morning");
  EXPECT_EQ(FindTown("Town5").light, "sunset");
}

TEST(FindTown, EvaluationPathsCloseALoopAndComeBackBothWays) {
  for (const char* name : {"Town1", "Town2", "Town3", "Town4", "Town5"}) {
    const TownSpec spec = FindTown(name);
    const StreetPlan plan = PlanTown(spec.seed, spec.plan);
    const Lap lap(plan, plan.tour, LapOf(spec));
    std::vector<Rigid3> path;
    double length = 0;
    for (int frame = 0; frame < spec.frames; ++frame) {
      path.push_back(CameraPose(lap, {}, frame / 20.0));
      if (frame > 0)
        length += (path[path.size() - 1].translation - path[path.size() - 2].translation).norm();
    }
    const Revisits revisits = FindRevisits(path);
    EXPECT_GT(revisits.same_fraction * length, 15) << name << ": metres of " << length;
    EXPECT_GT(revisits.opposite_fraction * length, 15) << name << ": metres of " << length;
    EXPECT_GT(length / spec.frames * 20, 5) << name << ": mean speed, stops included";
  }
}

TEST(FindTown, EvaluationPathsStopAndTurnSharply) {
  for (const char* name : {"Town1", "Town2", "Town3", "Town4", "Town5"}) {
    const TownSpec spec = FindTown(name);
    const StreetPlan plan = PlanTown(spec.seed, spec.plan);
    const Lap lap(plan, plan.tour, LapOf(spec));
    int standing = 0;
    int turning = 0;
    for (int frame = 0; frame < spec.frames; ++frame) {
      const Lap::State now = lap.At(frame / 20.0);
      EXPECT_LT(now.speed, 12.01) << name;
      standing += now.speed < 0.1 ? 1 : 0;
      const Vector2d forward = lap.PlaceAt(now.station).forward;
      const Vector2d soon = lap.PlaceAt(lap.At(frame / 20.0 + 3).station).forward;
      turning += forward.dot(soon) < 0.34 ? 1 : 0;  // by 70 degrees in 3 seconds
    }
    EXPECT_GE(standing, 10) << name;
    EXPECT_GE(turning, 100) << name;
  }
}

TEST(FindTown, RefusesOtherNames) {
  for (const char* name : {"", "Town6", "town1", "-3", "12x", "1e3", "1234567890123456789"})
    EXPECT_THROW(FindTown(name), UserError) << name;
}

}  // namespace
}  // namespace orb360::town
