#include "slam/io/positions/gpx_file.h"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/positions/utc_time.h"
#include "tests/slam/io/positions/shared_data.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

std::string Gpx(const std::string& points) {
  return "<?xml version=\"1.0\"?><gpx xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>" +
         points + "</trkseg></trk></gpx>";
}

TEST(Gpx, ReadsPlacesTimesAndPrecisionInTheOrderOfTime) {
  const PositionTrack track =
      ParseGpx(Gpx("<trkpt lat=\"2\" lon=\"-3.5\"><time>2025-03-14T09:00:01.25+02:00</time></trkpt>"
                   "<trkpt lat=\"1\" lon=\"-3\"><ele> 12.5 </ele><time>2025-03-14T07:00:00Z</time>"
                   "<hdop>1.5</hdop><vdop>2</vdop></trkpt>"
                   "<trkpt lat=\"5\" lon=\"-3\"><time>2025-03-14T07:00:00Z</time></trkpt>"
                   "<trkpt lat=\"7\" lon=\"7\"/>"),
               "a.gpx");
  ASSERT_EQ(track.fixes.size(), 2U);  // One repeats a time, and one has none.
  EXPECT_EQ(track.fixes[0].latitude, 1);
  EXPECT_EQ(*track.fixes[0].altitude, 12.5);
  EXPECT_EQ(*track.fixes[0].horizontal_sigma, 1.5 * kMetresPerDop);
  EXPECT_EQ(*track.fixes[0].vertical_sigma, 2 * kMetresPerDop);
  EXPECT_EQ(track.fixes[0].timestamp, 1741935600);
  EXPECT_EQ(track.fixes[1].timestamp, 1741935601.25);
  EXPECT_FALSE(track.fixes[1].altitude);
  EXPECT_EQ(track.clock, PositionClock::kUtc);
}

TEST(Gpx, ReadsTheSameAsPythonFromARealTrack) {
  const std::filesystem::path path = SharedData("positions/sf_30km_h.gpx");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  if (!HasProgram("python3")) GTEST_SKIP() << "there is no python3";
  // Python's own parser, in place of pugixml.
  const std::string script =
      "import sys, datetime, xml.etree.ElementTree as E\n"
      "n = '{http://www.topografix.com/GPX/1/1}'\n"
      "for p in E.parse(sys.argv[1]).iter(n + 'trkpt'):\n"
      "  t = datetime.datetime.fromisoformat(p.find(n + 'time').text.replace('Z', '+00:00'))\n"
      "  print(p.get('lat'), p.get('lon'), p.find(n + 'ele').text, repr(t.timestamp()))\n";
  const TempFolder folder;
  WriteText(folder / "gpx.py", script);
  std::istringstream lines(
      OutputOf("python3 '" + (folder / "gpx.py").string() + "' '" + path.string() + "'"));
  const PositionTrack track = ReadGpx(path);
  size_t i = 0;
  for (double lat = 0, lon = 0, ele = 0, time = 0; lines >> lat >> lon >> ele >> time; ++i) {
    ASSERT_LT(i, track.fixes.size());
    EXPECT_DOUBLE_EQ(track.fixes[i].latitude, lat);
    EXPECT_DOUBLE_EQ(track.fixes[i].longitude, lon);
    EXPECT_DOUBLE_EQ(*track.fixes[i].altitude, ele);
    EXPECT_NEAR(track.fixes[i].timestamp, time, 1e-6);
  }
  EXPECT_EQ(i, track.fixes.size());
  EXPECT_GT(i, 30U);
}

TEST(Gpx, SaysWhatIsWrongInOneLine) {
  const auto message = [](const std::string& text) {
    return MessageOf<UserError>([&] { ParseGpx(text, "a.gpx"); });
  };
  EXPECT_THAT(message("<gpx><trk>"), testing::HasSubstr("a.gpx: is damaged XML"));
  EXPECT_THAT(message("<kml/>"), testing::HasSubstr("no GPX file"));
  EXPECT_THAT(message(Gpx("")), testing::HasSubstr("no track point"));
  EXPECT_THAT(message(Gpx("<trkpt lat=\"1\" lon=\"2\"/>")), testing::HasSubstr("has a time"));
  EXPECT_THAT(message(Gpx("<trkpt lat=\"1\" lon=\"2\"><time>noon</time></trkpt>")),
              testing::HasSubstr("point 1: `noon` is not a time"));
  EXPECT_THAT(message(Gpx("<trkpt lat=\"nan\" lon=\"2\"><time>2025-03-14T07:00:00Z</time>"
                          "</trkpt>")),
              testing::HasSubstr("point 1: lat=\"nan\" is not an angle"));
  for (const char* text : {"<gpx><trk>", "<kml/>", "\0\1\2"}) {
    EXPECT_EQ(message(text).find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace orb360
