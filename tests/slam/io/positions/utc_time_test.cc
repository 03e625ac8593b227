#include "slam/io/positions/utc_time.h"

#include <ctime>

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(UtcTime, AgreesWithTheCLibraryOverACentury) {
  for (std::time_t seconds = -631152000; seconds < 4102444800; seconds += 7777777) {  // 1950-2100
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    EXPECT_EQ(UtcSeconds(parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday, parts.tm_hour,
                         parts.tm_min, parts.tm_sec),
              static_cast<double>(seconds));
    char text[40];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S.000Z", &parts);
    EXPECT_EQ(FormatIsoTime(static_cast<double>(seconds)), text);
    EXPECT_EQ(ParseIsoTime(text), static_cast<double>(seconds));
  }
}

TEST(UtcTime, ReadsZonesAndDecimals) {
  EXPECT_EQ(ParseIsoTime("1970-01-01T00:00:00"), 0);
  EXPECT_EQ(ParseIsoTime("1970-01-01 00:00:00.5Z"), 0.5);
  EXPECT_EQ(ParseIsoTime("1970-01-01T00:00:00-05:30"), 19800);
  EXPECT_EQ(ParseIsoTime("1970-01-01T02:00:00+0200"), 0);
  EXPECT_EQ(FormatIsoTime(-0.001), "1969-12-31T23:59:59.999Z");
}

TEST(UtcTime, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "2025", "2025-02-29T00:00:00Z", "2025-13-01T00:00:00Z", "2025-01-01T24:00:00Z",
        "2025-01-01T00:60:00Z", "2025-01-01T00:00:61Z", "2025-01-01T00:00:0Z",
        "2025-01-01T00:00:00+2:00", "2025-01-01T00:00:00.1.2Z", "2025-01-01T00:00:00X",
        "2025-01-01T00:00", "-025-01-01T00:00:00Z"}) {
    EXPECT_FALSE(ParseIsoTime(text)) << text;
  }
  EXPECT_THROW(FormatIsoTime(1e15), ContractError);
}

}  // namespace
}  // namespace orb360
