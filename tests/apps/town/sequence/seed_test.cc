#include "apps/town/sequence/seed.h"

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

TEST(Seed, IsAnIntegerOfAtMost18Digits) {
  EXPECT_EQ(RequireSeed("interior", "12"), 12U);
  EXPECT_EQ(ParseSeed("999999999999999999"), 999999999999999999U);
  for (const char* seed : {"", "Hall", "-1", "1.5", "1 ", "1234567890123456789"}) {
    EXPECT_EQ(ParseSeed(seed), std::nullopt) << seed;
    EXPECT_THROW(RequireSeed("interior", seed), UserError) << seed;
  }
}

}  // namespace
}  // namespace orb360::town
