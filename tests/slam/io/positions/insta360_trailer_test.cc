#include "slam/io/positions/insta360_trailer.h"

#include <sstream>

#include <gtest/gtest.h>

#include "tests/slam/io/positions/insta360_writer.h"

namespace orb360 {
namespace {

const std::string kVideo(1000, 'v');

Insta360Positions Parse(const std::string& bytes) {
  std::istringstream file(bytes);
  return ReadInsta360Positions(file);
}

/// Other records around one with three measurements, the second of which has no fix.
std::vector<Insta360Record> Records() {
  return {{1, "serial"},
          {7, Insta360Measurement(1.7e9 + 0.25, -33.5, -70.25, 520.5) +
                  Insta360Measurement(1.7e9 + 1, 1, 1, 1, 'V') +
                  Insta360Measurement(1.7e9 + 2, -33.5, -70.5, 521, 'A', 'O')},
          {3, std::string(40, 'g')}};
}

void ExpectTwoFixes(const Insta360Positions& positions) {
  ASSERT_EQ(positions.fixes.size(), 2U);
  EXPECT_EQ(positions.num_without_lock, 1);
  GeodeticFix first;
  first.timestamp = 1.7e9 + 0.25;
  first.latitude = -33.5;
  first.longitude = -70.25;
  first.altitude = 520.5;
  EXPECT_EQ(positions.fixes[0], first);
  EXPECT_EQ(positions.fixes[1].longitude, -70.5) << "west in French";
}

TEST(Insta360Trailer, RecordsAreFoundFromTheEnd) {
  ExpectTwoFixes(Parse(kVideo + Insta360Trailer(Records())));
}

TEST(Insta360Trailer, AnIndexTellsWhereRecordsAreThatDoNotAdjoin) {
  ExpectTwoFixes(Parse(kVideo + IndexedInsta360Trailer(Records())));
}

TEST(Insta360Trailer, AFileWithoutPositionsHasNone) {
  EXPECT_TRUE(Parse("").fixes.empty());
  EXPECT_TRUE(Parse(kVideo).fixes.empty());
  EXPECT_TRUE(Parse(kVideo + Insta360Trailer({})).fixes.empty());
  EXPECT_TRUE(Parse(kVideo + Insta360Trailer({{3, "gyro"}})).fixes.empty());
  EXPECT_TRUE(Parse(kVideo + IndexedInsta360Trailer({{3, "gyro"}})).fixes.empty());
}

TEST(Insta360Trailer, EveryBeginningAndEveryDamagedByteIsReadWithoutHarm) {
  for (const std::string& trailer :
       {Insta360Trailer(Records()), IndexedInsta360Trailer(Records())}) {
    for (size_t size = 0; size < trailer.size(); ++size) {
      EXPECT_TRUE(Parse(trailer.substr(0, size)).fixes.empty()) << size;
    }
    for (size_t i = 0; i < trailer.size(); ++i) {
      for (const char byte : {'\0', '\x7f', '\xff'}) {
        std::string damaged = trailer;
        damaged[i] = byte;
        for (const GeodeticFix& fix : Parse(damaged).fixes) EXPECT_TRUE(IsPlausible(fix));
      }
    }
  }
}

}  // namespace
}  // namespace orb360
