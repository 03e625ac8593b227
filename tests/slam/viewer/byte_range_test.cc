#include "slam/viewer/byte_range.h"

#include <string>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

std::string Parsed(std::string_view header, std::uint64_t size) {
  const std::optional<ByteRange> range = ParseByteRange(header, size);
  if (!range) return "none";
  return std::to_string(range->begin) + " " + std::to_string(range->end);
}

TEST(ByteRange, ReadsTheThreeFormsOfTheStandard) {
  EXPECT_EQ(Parsed("bytes=0-0", 100), "0 1");
  EXPECT_EQ(Parsed("bytes=10-19", 100), "10 20");
  EXPECT_EQ(Parsed("bytes=90-", 100), "90 100");
  EXPECT_EQ(Parsed("bytes=-7", 100), "93 100");
}

TEST(ByteRange, EndsWithTheResource) {
  EXPECT_EQ(Parsed("bytes=90-1000", 100), "90 100");
  EXPECT_EQ(Parsed("bytes=90-18446744073709551615", 100), "90 100");
  EXPECT_EQ(Parsed("bytes=-1000", 100), "0 100");
}

TEST(ByteRange, RefusesWhatHasNoByteOrIsNoRange) {
  for (const char* header :
       {"bytes=100-", "bytes=100-200", "bytes=-0", "bytes=-", "bytes=", "bytes=5-4", "bytes=a-b",
        "bytes=1-2,4-5", "bytes= 1-2", "bytes=1-2 ", "bytes=+1-2", "bytes=1.5-2", "bytes=0x1-2",
        "bytes=99999999999999999999-", "bytes=1", "Bytes=0-1", "lines=0-1", "", "bytes=--1"}) {
    EXPECT_EQ(Parsed(header, 100), "none") << header;
  }
  EXPECT_EQ(Parsed("bytes=0-", 0), "none");
  EXPECT_EQ(Parsed("bytes=-1", 0), "none");
}

}  // namespace
}  // namespace orb360
