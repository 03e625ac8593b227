#include "apps/town/sequence/named_town.h"

#include <set>

#include <gtest/gtest.h>

#include "apps/town/sequence/town_drive.h"
#include "slam/check.h"

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

TEST(FindTown, ToursCloseALoopWithinTheSequence) {
  // A tour of several blocks is back at a junction when the first block is circled, well before
  // the lap is over.
  for (const char* name : {"Town1", "Town2", "Town3", "Town4", "Town5", "Loop"}) {
    const TownSpec spec = FindTown(name);
    const StreetPlan plan = PlanTown(spec.seed, spec.plan);
    const Lap lap(plan, plan.tour, LapOf(spec));
    const double lap_frames = 20 * lap.duration();
    const double share = spec.plan.tour_blocks == 1 ? 0.95 : 1.1;
    EXPECT_LT(lap_frames, share * spec.frames) << name << ": " << lap.length() << " m";
    EXPECT_GT(lap_frames, 0.4 * spec.frames) << name << ": " << lap.length() << " m";
  }
}

TEST(FindTown, RefusesOtherNames) {
  for (const char* name : {"", "Town6", "town1", "-3", "12x", "1e3", "1234567890123456789"})
    EXPECT_THROW(FindTown(name), UserError) << name;
}

}  // namespace
}  // namespace orb360::town
