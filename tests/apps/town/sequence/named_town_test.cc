#include "apps/town/sequence/named_town.h"

#include <set>

#include <gtest/gtest.h>

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

TEST(FindTown, RefusesOtherNames) {
  for (const char* name : {"", "Town6", "town1", "-3", "12x", "1e3", "1234567890123456789"})
    EXPECT_THROW(FindTown(name), UserError) << name;
}

}  // namespace
}  // namespace orb360::town
