#include "slam/io/positions/read_positions.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/positions/camm.h"
#include "slam/io/positions/utc_time.h"
#include "tests/slam/io/positions/camm_writer.h"
#include "tests/slam/io/positions/exif_writer.h"
#include "tests/slam/io/positions/gpmf_writer.h"
#include "tests/slam/io/positions/insta360_writer.h"
#include "tests/slam/io/positions/mp4_writer.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using testing::HasSubstr;

std::string Refusal(const std::filesystem::path& path) {
  return MessageOf<UserError>([&] { ReadPositions(path); });
}

std::string Telemetry(int fix) {
  std::vector<std::string> samples;
  for (int i = 0; i < 6; ++i) {
    GpmfMeasurement measurement{47.5, 8.25, 400.5};
    measurement.fix = fix;
    samples.push_back(WriteGps5({measurement}, "240229000000.000"));
  }
  return WithMetadataTrack(EmptyMp4(), "gpmd", samples, 1000);
}

TEST(ReadPositions, TellsInOneLineWhyThereAreNone) {
  const TempFolder folder;
  EXPECT_THAT(Refusal(folder / "none.gpx"), HasSubstr("no such file"));
  WriteText(folder / "empty.gpx", "");
  EXPECT_THAT(Refusal(folder / "empty.gpx"), HasSubstr("is empty (0 bytes)"));
  WriteText(folder / "empty.mp4", "");
  EXPECT_THAT(Refusal(folder / "empty.mp4"), HasSubstr("is empty (0 bytes)"));
  WriteText(folder / "noise.mp4", "these are some words, and no video");
  EXPECT_THAT(Refusal(folder / "noise.mp4"), HasSubstr("neither GPX nor a video"));
  WriteText(folder / "silent.mp4", WithMetadataTrack(EmptyMp4(), "fdsc", {"abcd", "efgh"}, 1000));
  EXPECT_THAT(Refusal(folder / "silent.mp4"), HasSubstr("has no positions: neither a GPMF"));
  WriteText(folder / "indoors.mp4", Telemetry(0));
  EXPECT_THAT(Refusal(folder / "indoors.mp4"), HasSubstr("no satellites in any of 6"));
  WriteText(folder / "void.insv",
            EmptyMp4() + Insta360Trailer({{7, Insta360Measurement(1.7e9, 1, 2, 3, 'V')}}));
  EXPECT_THAT(Refusal(folder / "void.insv"), HasSubstr("no satellites in any of 1"));
  const std::string whole = Telemetry(3);
  WriteText(folder / "cut.mp4", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Refusal(folder / "cut.mp4"), HasSubstr("cut off"));
  WriteText(folder / "short.gpx",
            "<gpx><trk><trkseg><trkpt lat=\"1\" lon=\"2\"><time>2025-03-14T07:00:00Z</time></trkpt>"
            "</trkseg></trk></gpx>");
  EXPECT_THAT(Refusal(folder / "short.gpx"), HasSubstr("has 1 positions, and at least 6"));
  cv::imwrite((folder / "a.jpg").string(), cv::Mat(8, 16, CV_8UC3, cv::Scalar(1, 2, 3)));
  EXPECT_THAT(Refusal(folder.path()), HasSubstr("none of its images has a position"));
}

TEST(ReadPositions, FindsNothingInAnInputWithoutTelemetry) {
  const TempFolder folder;
  WriteText(folder / "silent.mp4", WithMetadataTrack(EmptyMp4(), "fdsc", {"abcd"}, 1000));
  EXPECT_FALSE(FindPositions(folder / "silent.mp4"));
  WriteText(folder / "a.mp4", Telemetry(3));
  EXPECT_TRUE(FindPositions(folder / "a.mp4"));
}

TEST(ReadPositions, KnowsAGpxFileByItsContent) {
  const TempFolder folder;
  std::string text = "<gpx><trk><trkseg>";
  for (const char* second : {"00", "01", "02", "03", "04", "05"}) {
    text += "<trkpt lat=\"1\" lon=\"2\"><time>2025-03-14T07:00:";
    text += second;
    text += "Z</time></trkpt>";
  }
  WriteText(folder / "track", text + "</trkseg></trk></gpx>");
  EXPECT_EQ(ReadPositions(folder / "track").fixes.size(), 6U);
}

TEST(ReadPositions, TakesTheEpochOfCammThatFitsTheCamerasClock) {
  const TempFolder folder;
  const double utc = *ParseIsoTime("2024-05-06T07:08:09Z");
  const auto created = static_cast<std::uint32_t>(utc + 2082844800 - 7200);  // since 1904
  for (const double epoch : {0.0, kGpsEpoch}) {
    std::vector<std::string> samples;
    for (int i = 0; i < 6; ++i) {
      samples.push_back(CammType6(utc - epoch + i, 3, 48, 11, 500, 2, 4));
    }
    WriteText(folder / "a.mp4", WithMetadataTrack(EmptyMp4(created), "camm", samples, 1000));
    EXPECT_NEAR(*ReadPositions(folder / "a.mp4").utc_at_zero, utc, 1e-3) << epoch;
  }
}

TEST(ReadPositions, TimesThatNoClockHasAreLeftOut) {
  const TempFolder folder;
  for (const double time : {std::nan(""), 1.3e12, -1e300}) {
    std::vector<std::string> samples(6, CammType6(time, 3, 48, 11, 500, 2, 4));
    WriteText(folder / "a.mp4", WithMetadataTrack(EmptyMp4(), "camm", samples, 1000));
    const PositionTrack track = ReadPositions(folder / "a.mp4");
    EXPECT_EQ(track.fixes.size(), 6U) << "the video has times";
    EXPECT_FALSE(track.utc_at_zero) << time;
  }
  std::string measurements = Insta360Measurement(std::pow(2.0, 40), 48, 11, 500);
  for (int i = 0; i < 6; ++i) measurements += Insta360Measurement(1.7e9 + i, 48, 11, 500);
  WriteText(folder / "a.insv", EmptyMp4() + Insta360Trailer({{7, measurements}}));
  EXPECT_EQ(ReadPositions(folder / "a.insv").fixes.back().timestamp, 1.7e9 + 5);
}

TEST(ReadPositions, ImagesAreInTheOrderOfTheirTimesAlsoWithAnotherFrameRate) {
  const TempFolder folder;
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(8, 16, CV_8UC3, cv::Scalar(90, 120, 60)), jpeg);
  const std::string bytes(jpeg.begin(), jpeg.end());
  for (int i = 0; i < 6; ++i) {  // f.jpg is the first one
    ExifFields fields{1 + 0.1 * i, 2, 3};
    fields.taken = "2024:02:29 12:00:00";
    fields.taken.back() = static_cast<char>('0' + i);
    WriteText(folder / (std::string(1, static_cast<char>('f' - i)) + ".jpg"),
              WithExif(bytes, fields));
  }
  const PositionTrack track = ReadPositions(folder.path(), 5.0);
  ASSERT_EQ(track.fixes.size(), 6U);
  for (const GeodeticFix& fix : track.fixes) {
    EXPECT_NEAR(fix.latitude, 1 + 0.1 * 5 * fix.timestamp, 1e-8);
  }
}

TEST(ReadPositions, CountsImagesWithoutAPositionAsFrames) {
  const TempFolder folder;
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(8, 16, CV_8UC3, cv::Scalar(90, 120, 60)), jpeg);
  const std::string bytes(jpeg.begin(), jpeg.end());
  for (int i = 0; i < 12; ++i) {
    WriteText(folder / (std::to_string(i) + ".jpg"),
              i % 3 == 0 ? bytes : WithExif(bytes, {1 + 0.1 * i, 2, 3}));
  }
  const PositionTrack track = ReadPositions(folder.path(), 5.0);
  ASSERT_EQ(track.fixes.size(), 8U);
  for (const GeodeticFix& fix : track.fixes) {
    EXPECT_NEAR(fix.latitude, 1 + 0.1 * 5 * fix.timestamp, 1e-8);  // 10 after 2, not before
  }
}

}  // namespace
}  // namespace orb360
