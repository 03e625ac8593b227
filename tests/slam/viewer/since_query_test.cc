#include "slam/viewer/since_query.h"

#include <optional>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(ParseSince, ReadsTheRevisionThatAPageHas) {
  EXPECT_EQ(ParseSince("since=0"), 0U);
  EXPECT_EQ(ParseSince("since=417"), 417U);
  EXPECT_EQ(ParseSince("since=18446744073709551615"), 18446744073709551615U);
  EXPECT_EQ(ParseSince(""), 0U);
}

TEST(ParseSince, ReadsNothingElse) {
  for (const char* query : {"since", "since=", "since=-1", "since=+1", "since= 1", "since=1&a=2",
                            "since=1.5", "Since=1", "x=1", "since=18446744073709551616"}) {
    EXPECT_EQ(ParseSince(query), std::nullopt) << query;
  }
}

}  // namespace
}  // namespace orb360
