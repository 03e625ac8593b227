#include <cstdio>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "nn/base/number_text.h"
#include "slam/io/positions/georeference.h"
#include "slam/io/positions/utc_time.h"
#include "tests/apps/orb360/run_fixture.h"
#include "tests/slam/io/jpeg_with_metadata.h"
#include "tests/slam/io/positions/exif_writer.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Where the camera of TexturedRoom is, which walks 4 cm a frame, every frame a second; `enlarged`
/// is the length of a metre.
std::string RoomTrack(double enlarged) {
  const Projection local = Projection::Local({47, 8, 400});
  std::string text = "<gpx><trk><trkseg>";
  for (int i = 0; i < kFrames; ++i) {
    const GeodeticPoint place =
        local.ToGeodetic(enlarged * TexturedRoom::WorldFromCamera(i).translation);
    text += "<trkpt lat=\"" + ToFixedText(place.latitude, 12) + "\" lon=\"" +
            ToFixedText(place.longitude, 12) + "\"><ele>" + ToFixedText(place.height, 6) +
            "</ele><time>" + FormatIsoTime(1.7e9 + i) + "</time><hdop>0.03</hdop></trkpt>";
  }
  return text + "</trkseg></trk></gpx>";
}

std::string JpegName(int i) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.jpg", i);
  return name;
}

/// Writes the room's images with their place in Exif; `enlarged` is the length of a metre.
void WriteRoomWithExif(const std::filesystem::path& folder, double enlarged) {
  std::filesystem::create_directories(folder);
  const Projection local = Projection::Local({47, 8, 400});
  const std::vector<cv::Mat> images = TexturedRoom(kSize).DrawAll(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    const GeodeticPoint place =
        local.ToGeodetic(enlarged * TexturedRoom::WorldFromCamera(i).translation);
    WriteJpeg(folder / JpegName(i), images[static_cast<size_t>(i)],
              WriteExifSegment({.latitude = place.latitude,
                                .longitude = place.longitude,
                                .altitude = place.height,
                                .horizontal_error = 0.05}));
  }
}

class RunPositionsTest : public RunTest {
 protected:
  void SetUp() override {
    if (!Projection::IsAvailable()) GTEST_SKIP() << "this build has no PROJ";
  }
  ProgramResult RunWith(const std::string& track, const std::vector<std::string>& more = {}) const {
    WriteText(folder_ / "room.gpx", track);
    std::vector<std::string> arguments = {
        "--fps", "1", "--positions", folder_ / "room.gpx", "--utc-start", FormatIsoTime(1.7e9)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run(arguments);
  }
};

TEST_F(RunPositionsTest, TellTheScaleAndPlaceTheRun) {
  WriteRoom();
  constexpr double kEnlarged = 3;
  const ProgramResult result = RunWith(RoomTrack(kEnlarged));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("placed on Earth by GPX"));
  const nlohmann::json positions = Summary()["positions"];
  EXPECT_EQ(positions["failure"], nullptr);
  EXPECT_EQ(positions["fixes"], kFrames);
  EXPECT_THAT(Summary()["scale"]["sources"].dump(), HasSubstr("positions"));
  // The map has the positions' metres, so that placing changes no length.
  EXPECT_NEAR(positions["scale"], 1, 0.02);
  const std::vector<StampedPose> poses = ReadTrajectory(OutFile("trajectory.txt"));
  const double walked = (TexturedRoom::WorldFromCamera(kFrames - 1).translation -
                         TexturedRoom::WorldFromCamera(0).translation)
                            .norm();
  EXPECT_NEAR(
      (poses.back().world_from_camera.translation - poses.front().world_from_camera.translation)
          .norm(),
      kEnlarged * walked, 0.05 * kEnlarged * walked);
  EXPECT_NEAR(ReadGeoreference(OutFile("georeference.json")).origin.latitude, 47, 1e-4);
  // A later run in the same folder without positions leaves no place of this one behind.
  EXPECT_EQ(Run({"--positions", "none"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(OutFile("georeference.json")));
  EXPECT_EQ(Summary()["positions"], nullptr);
}

TEST_F(RunPositionsTest, OfImagesAreThoseInTheirExif) {
  // The camera is 40 times as high above the ground as is assumed: a drone.
  WriteRoomWithExif(Input(), 40);
  ProgramResult result = Run({"--fps", "1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("placed on Earth by Exif of the images in"));
  EXPECT_EQ(Summary()["positions"]["fixes"], kFrames);
  EXPECT_NEAR(Summary()["positions"]["scale"], 1, 0.05);
  EXPECT_EQ(Summary()["scale"]["state"], "metric");
  EXPECT_NEAR(ReadGeoreference(OutFile("georeference.json")).origin.latitude, 47, 1e-3);

  // The same images as a sequence folder.
  std::filesystem::rename(Input(), folder_ / "rgb");
  std::filesystem::create_directories(Input());
  std::filesystem::rename(folder_ / "rgb", folder_ / "input" / "rgb");
  WriteText(folder_ / "input" / "sequence.yaml", "camera:\n  model: equirectangular\nfps: 1\n");
  result = Run();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("placed on Earth by Exif of the images in"));
  EXPECT_EQ(Summary()["positions"]["fixes"], kFrames);
  EXPECT_NEAR(Summary()["positions"]["scale"], 1, 0.05);
}

TEST_F(RunPositionsTest, OfTheInputThatCannotBeUsedAreAWarningAndTheRunSucceeds) {
  WriteRoomWithExif(Input(), 0);  // The receiver stands still.
  ProgramResult result = Run({"--fps", "1"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(Summary()["positions"]["failure"], HasSubstr("do not move far enough"));
  EXPECT_FALSE(std::filesystem::exists(OutFile("georeference.json")));
  EXPECT_EQ(PosesIn("trajectory.txt"), static_cast<size_t>(kFrames));

  // Two positions are no track.
  for (int i = 2; i < kFrames; ++i) {
    cv::imwrite((folder_ / "input" / JpegName(i)).string(), TexturedRoom(kSize).Draw(i));
  }
  result = Run({"--fps", "1"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(Summary()["warnings"].dump(),
              AllOf(HasSubstr("the positions of the input are not used"), HasSubstr("has 2 pos")));
  EXPECT_EQ(Summary()["positions"], nullptr);
}

TEST_F(RunPositionsTest, ThatDoNotFitAreToldAtTheEndAndEverythingIsWritten) {
  WriteRoom();
  const ProgramResult result = RunWith(RoomTrack(0));  // The receiver stands still.
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("room.gpx: its positions")));
  EXPECT_EQ(PosesIn("trajectory.txt"), static_cast<size_t>(kFrames));
  EXPECT_FALSE(std::filesystem::exists(OutFile("georeference.json")));
  EXPECT_THAT(Summary()["positions"]["failure"], HasSubstr("do not move far enough"));
  EXPECT_EQ(Summary()["interrupted"], false);
}

TEST_F(RunPositionsTest, ThatCannotBeReadAreRefusedBeforeAnyWork) {
  WriteBlanks();
  EXPECT_THAT(Refusal({"--positions", folder_ / "absent.gpx"}), HasSubstr("absent.gpx: no such"));
  const std::string whole = RoomTrack(1);
  WriteText(folder_ / "cut.gpx", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Refusal({"--positions", folder_ / "cut.gpx"}), HasSubstr("is damaged XML"));
  EXPECT_THAT(Refusal({"--utc-start", "noon"}), HasSubstr("--utc-start: `noon`"));
}

}  // namespace
}  // namespace orb360
