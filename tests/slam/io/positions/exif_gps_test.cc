#include "slam/io/positions/exif_gps.h"

#include <sstream>

#include <gtest/gtest.h>

#include "slam/io/jpeg_metadata.h"
#include "tests/slam/io/positions/exif_writer.h"

namespace orb360 {
namespace {

const std::string kStart = "\xff\xd8";

std::optional<ExifPosition> Parse(const std::string& jpeg) {
  std::istringstream file(jpeg);
  return ParseExifGps(ReadJpegMetadata(file).exif);
}

TEST(ExifGps, ReadsBothOrdersOfBytesAndAllFourQuadrants) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const double latitude : {-41.2924, 41.2924}) {
      for (const double longitude : {-174.7787, 174.7787}) {
        const auto position = Parse(WithExif(kStart, {latitude, longitude, 12.5, 1}, order));
        ASSERT_TRUE(position);
        EXPECT_NEAR(position->fix.latitude, latitude, 1e-8);
        EXPECT_NEAR(position->fix.longitude, longitude, 1e-8);
        EXPECT_NEAR(*position->fix.altitude, -12.5, 1e-9);
        EXPECT_EQ(position->altitude_reference, AltitudeReference::kMeanSeaLevel);
        EXPECT_FALSE(position->utc);
      }
    }
  }
}

// Exif 3.0 measures heights from the ellipsoid unless they say otherwise.
TEST(ExifGps, HeightsAreAboveTheSurfaceThatTheVersionAndTheReferenceName) {
  const auto parse = [](int version, int reference) {
    ExifFields fields{1, 2, 30, reference};
    fields.version = version;
    return *Parse(WithExif(kStart, fields));
  };
  for (const int reference : {0, 1, 2, 3}) {
    for (const int version : {2, 3, 4}) {
      const ExifPosition position = parse(version, reference);
      EXPECT_EQ(*position.fix.altitude, reference % 2 == 0 ? 30 : -30);
      EXPECT_EQ(position.altitude_reference, version == 4 && reference < 2
                                                 ? AltitudeReference::kEllipsoid
                                                 : AltitudeReference::kMeanSeaLevel)
          << version << " " << reference;
    }
  }
}

TEST(ExifGps, SkipsSegmentsBeforeTheExifOne) {
  std::string jfif = "\xff\xe0";
  Append(&jfif, std::uint16_t{16});
  jfif += std::string(14, 'x');
  EXPECT_TRUE(Parse(kStart + jfif + WriteExifSegment({1, 2, 3})));
}

TEST(ExifGps, EveryBeginningOfAFileAndEveryDamagedByteIsReadWithoutHarm) {
  const std::string whole = WithExif(kStart, {10.5, 20.5, 30, 0, "2024:02:29", 3661, 2});
  ASSERT_TRUE(Parse(whole));
  int num_read = 0;
  for (size_t size = 0; size < whole.size(); ++size) {
    // A heap copy, so that AddressSanitizer sees what reads beyond it.
    num_read += Parse(std::string(whole.substr(0, size))) ? 1 : 0;
  }
  EXPECT_LT(num_read, 60);  // Only the optional fields at the end may be missing.
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const char byte : {'\0', '\x7f', '\xff'}) {
      std::string damaged = whole;
      damaged[i] = byte;
      const auto position = Parse(damaged);
      EXPECT_TRUE(!position || IsPlausible(position->fix));
    }
  }
}

TEST(ExifGps, HasNoPositionWithoutTheHemisphere) {
  std::string file = WithExif(kStart, {10.5, 20.5, 30});
  file[file.find("N\0\0\0", 0, 4)] = '?';
  EXPECT_FALSE(Parse(file));
}

}  // namespace
}  // namespace orb360
