#include "slam/io/jpeg_metadata.h"

#include <ctime>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/slam/io/jpeg_with_metadata.h"

namespace orb360 {
namespace {

JpegMetadata Read(const std::string& segments) {
  std::istringstream file("\xff\xd8" + segments + "\xff\xda");
  return ReadJpegMetadata(file);
}

std::optional<double> ReadTime(const std::string& segments) {
  return ExifTime(Read(segments).exif);
}

TEST(JpegMetadata, HoldTheTimeInBothOrdersOfBytes) {
  std::tm time{};
  time.tm_year = 2024 - 1900;
  time.tm_mon = 1;
  time.tm_mday = 29;
  time.tm_hour = 13;
  time.tm_min = 5;
  time.tm_sec = 59;
  for (const bool is_big_endian : {false, true}) {
    const auto found = ReadTime(ExifSegment("2024:02:29 13:05:59", "2500", is_big_endian));
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(*found, static_cast<double>(timegm(&time)) + 0.25);
  }
}

TEST(JpegMetadata, WhatIsNoTimeIsNone) {
  EXPECT_FALSE(ReadTime(ExifSegment("2023:02:29 13:05:59", "2500")));
  EXPECT_FALSE(ReadTime(ExifSegment("    :  :     :  :  ", "    ")));
  EXPECT_TRUE(ReadTime(ExifSegment("2024:02:29 13:05:59", "    ")));
  EXPECT_FALSE(ReadTime(""));
}

TEST(JpegMetadata, XmpIsFoundAmongOtherSegments) {
  const std::string comment("\xff\xfe\0\5abc", 7);
  EXPECT_EQ(Read(comment + XmpSegment("<x/>") + ExifSegment("2024:02:29 13:05:59", "0000")).xmp,
            "<x/>");
  EXPECT_EQ(Read(comment).xmp, "");
}

TEST(JpegMetadata, EveryTruncationIsReadWithoutHarm) {
  const std::string exif = ExifSegment("2024:02:29 13:05:59", "2500");
  for (size_t size = 0; size <= exif.size(); ++size) {
    std::istringstream file("\xff\xd8" + exif.substr(0, size));
    EXPECT_EQ(ExifTime(ReadJpegMetadata(file).exif).has_value(), size == exif.size()) << size;
  }
  // The text of the time ends at byte 76 of the structure.
  const std::string tiff = exif.substr(10);
  for (size_t size = 0; size <= tiff.size(); ++size) {
    EXPECT_EQ(ExifTime(std::string_view(tiff).substr(0, size)).has_value(), size >= 76) << size;
  }
}

}  // namespace
}  // namespace orb360
