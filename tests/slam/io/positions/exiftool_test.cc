// Every reader of positions against Exiftool, which reads the same files independently.

#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/positions/read_positions.h"
#include "slam/io/positions/utc_time.h"
#include "tests/slam/io/positions/camm_writer.h"
#include "tests/slam/io/positions/exif_writer.h"
#include "tests/slam/io/positions/gpmf_writer.h"
#include "tests/slam/io/positions/insta360_writer.h"
#include "tests/slam/io/positions/mp4_writer.h"
#include "tests/slam/io/positions/shared_data.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

/// A position as Exiftool prints it, with the time of the sample of the track in which it is.
struct Printed {
  double latitude = 0, longitude = 0;
  std::optional<double> altitude, error;
  double sample_start = 0, sample_duration = 0;
};

/// `exiftool -ee` prints each sample of a telemetry track as a document: its time, the error of its
/// positions, and then one position after the other.
std::vector<Printed> AskExiftool(const std::filesystem::path& path) {
  std::istringstream lines(OutputOf("exiftool -ee -n -a -s -G3 '" + path.string() + "'"));
  std::vector<Printed> all;
  Printed sample;
  std::string document;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string group, tag, colon, text;
    words >> group >> tag >> colon >> text;
    if (!group.starts_with("[Doc") && !group.starts_with("[Main]")) continue;
    if (group != document) sample = {};
    document = group;
    const double value = std::strtod(text.c_str(), nullptr);
    if (tag == "SampleTime") sample.sample_start = value;
    if (tag == "SampleDuration") sample.sample_duration = value;
    if (tag == "GPSHPositioningError" || tag == "GPSHorizontalAccuracy") {
      sample.error = value;
      if (tag == "GPSHorizontalAccuracy" && !all.empty()) all.back().error = value;
    }
    if (tag == "GPSLatitude") {
      all.push_back(sample);
      all.back().latitude = value;
    }
    if (all.empty()) continue;
    if (tag == "GPSLongitude") all.back().longitude = value;
    if (tag == "GPSAltitude") all.back().altitude = value;
  }
  return all;
}

/// All values agree. `error_unit`: what one unit of the printed error is in standard deviations.
void ExpectSame(const PositionTrack& track, const std::vector<Printed>& printed,
                double metres_per_error) {
  ASSERT_EQ(track.fixes.size(), printed.size());
  for (size_t i = 0; i < printed.size(); ++i) {
    const GeodeticFix& fix = track.fixes[i];
    EXPECT_NEAR(fix.latitude, printed[i].latitude, 1e-11) << i;
    EXPECT_NEAR(fix.longitude, printed[i].longitude, 1e-11) << i;
    ASSERT_EQ(fix.altitude.has_value(), printed[i].altitude.has_value()) << i;
    if (fix.altitude) {
      EXPECT_NEAR(*fix.altitude, *printed[i].altitude, 1e-6) << i;
    }
    ASSERT_EQ(fix.horizontal_sigma.has_value(), printed[i].error.has_value()) << i;
    if (fix.horizontal_sigma) {
      EXPECT_NEAR(*fix.horizontal_sigma, *printed[i].error * metres_per_error, 1e-6) << i;
    }
  }
}

#define SKIP_WITHOUT_EXIFTOOL()                                                     \
  if (!HasProgram("exiftool")) {                                                    \
    GTEST_SKIP() << "there is no exiftool (Debian package libimage-exiftool-perl)"; \
  }

TEST(Exiftool, ReadsTheSamePositionsFromTheVideoOfAGoProMax) {
  const std::filesystem::path path = SharedData("positions/max-heromode.mp4");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  SKIP_WITHOUT_EXIFTOOL();
  std::vector<Printed> printed = AskExiftool(path);
  ASSERT_GT(printed.size(), 150U);
  // The first one is the place that the file's header states, without an altitude.
  ASSERT_FALSE(printed.front().altitude);
  printed.erase(printed.begin());
  const PositionTrack track = ReadPositions(path);
  EXPECT_EQ(track.clock, PositionClock::kVideo);
  ExpectSame(track, printed, kMetresPerDop);
  // Positions are spread evenly over the sample that contains them.
  for (size_t i = 0; i < printed.size();) {
    size_t end = i;
    while (end < printed.size() && printed[end].sample_start == printed[i].sample_start) ++end;
    for (size_t k = i; k < end; ++k) {
      const double fraction = static_cast<double>(k - i) / static_cast<double>(end - i);
      EXPECT_NEAR(track.fixes[k].timestamp,
                  printed[k].sample_start + fraction * printed[k].sample_duration, 1e-3);
    }
    i = end;
  }
  // Its receiver says 2019-11-18 23:45:16.470 for the second sample, which begins at 1.001 s.
  EXPECT_NEAR(*track.utc_at_zero, *ParseIsoTime("2019-11-18T23:45:15.469Z"), 0.3);
}

TEST(Exiftool, ReadsTheSamePositionsFromGeneratedGpmf) {
  SKIP_WITHOUT_EXIFTOOL();
  const TempFolder folder;
  std::vector<std::string> samples;
  for (int i = 0; i < 5; ++i) {
    std::vector<GpmfMeasurement> measurements;
    for (int k = 0; k < 10 + i; ++k) {
      measurements.push_back({-33.5 + 1e-5 * (20 * i + k), 151.25 - 2e-5 * k, 12.5 + i, 1.25});
    }
    samples.push_back(WriteGps5(measurements, "25010203040" + std::to_string(i) + ".500"));
  }
  WriteText(folder / "a.mp4", WithMetadataTrack(EmptyMp4(), "gpmd", samples, 1001));
  const PositionTrack track = ReadPositions(folder / "a.mp4");
  ExpectSame(track, AskExiftool(folder / "a.mp4"), kMetresPerDop);
  EXPECT_EQ(track.fixes.size(), 60U);
}

TEST(Exiftool, ReadsTheSamePositionsFromGeneratedCamm) {
  SKIP_WITHOUT_EXIFTOOL();
  const TempFolder folder;
  std::vector<std::string> samples;
  for (int i = 0; i < 20; ++i) {
    samples.push_back(CammType2());
    samples.push_back(CammType6(1.4e9 + i, 3, 48.1 + 1e-5 * i, -11.5, 519.25F, 2.5F, 5.F));
  }
  WriteText(folder / "a.mp4", WithMetadataTrack(EmptyMp4(), "camm", samples, 500));
  ExpectSame(ReadPositions(folder / "a.mp4"), AskExiftool(folder / "a.mp4"),
             1 / std::sqrt(-2 * std::log(0.32)));
  samples.clear();
  for (int i = 0; i < 20; ++i) samples.push_back(CammType5(48.1 + 1e-5 * i, 11.5, 519.125));
  WriteText(folder / "b.mp4", WithMetadataTrack(EmptyMp4(), "camm", samples, 500));
  ExpectSame(ReadPositions(folder / "b.mp4"), AskExiftool(folder / "b.mp4"), 1);
}

TEST(Exiftool, ReadsTheSamePositionsFromAGeneratedTrailerOfInsta360) {
  SKIP_WITHOUT_EXIFTOOL();
  const TempFolder folder;
  std::string measurements;
  for (int i = 0; i < 20; ++i) {
    measurements +=
        Insta360Measurement(1.7e9 + i, -48.1 - 1e-5 * i, -11.5, 519.25 + i, i % 5 == 4 ? 'V' : 'A');
  }
  const std::string trailer = Insta360Trailer({{7, measurements}, {4, std::string(16, '\0')}});
  WriteText(folder / "a.insv", EmptyMp4() + trailer);
  const PositionTrack track = ReadPositions(folder / "a.insv");
  EXPECT_EQ(track.fixes.size(), 16U);
  EXPECT_EQ(track.clock, PositionClock::kUtc);
  EXPECT_EQ(track.fixes.back().timestamp, 1.7e9 + 18);
  ExpectSame(track, AskExiftool(folder / "a.insv"), 1);
}

TEST(Exiftool, ReadsTheSamePositionsFromGeneratedExif) {
  SKIP_WITHOUT_EXIFTOOL();
  const TempFolder folder;
  const cv::Mat image(8, 16, CV_8UC3, cv::Scalar(90, 120, 60));
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", image, jpeg);
  const std::string bytes(jpeg.begin(), jpeg.end());
  std::vector<Printed> printed;
  for (int i = 0; i < 6; ++i) {
    const ExifFields fields{-12.3456789 + 1e-4 * i, 98.7654321,  105.25, i % 2,
                            "2024:02:29",           3661.25 + i, 3.5};
    const std::filesystem::path path = folder / (std::to_string(i) + ".jpg");
    WriteText(path, WithExif(bytes, fields, i < 2 ? std::endian::little : std::endian::big));
    // Numbers that are not signed but have a reference beside them: Exiftool's composite ones are.
    const std::string text = OutputOf(
        "exiftool -n -s3 -Composite:GPSLatitude -Composite:GPSLongitude -Composite:GPSAltitude "
        "-GPSHPositioningError -Composite:GPSDateTime '" +
        path.string() + "'");
    std::istringstream lines(text);
    Printed one;
    double altitude = 0, error = 0;
    lines >> one.latitude >> one.longitude >> altitude >> error;
    one.altitude = altitude;
    one.error = error;
    printed.push_back(one);
    std::string date, time;
    lines >> date >> time;
    EXPECT_EQ(date, "2024:02:29");
  }
  const PositionTrack track = ReadPositions(folder.path(), 10.0);
  ExpectSame(track, printed, 1);
  EXPECT_EQ(track.clock, PositionClock::kFrames);
  EXPECT_NEAR(track.fixes[3].timestamp, 0.3, 1e-12);
  EXPECT_NEAR(*track.utc_at_zero, *ParseIsoTime("2024-02-29T01:01:01.25Z"), 1e-6);
}

}  // namespace
}  // namespace orb360
