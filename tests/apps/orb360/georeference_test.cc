#include "slam/io/positions/georeference.h"

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "nn/base/number_text.h"
#include "slam/io/positions/utc_time.h"
#include "slam/io/sparse_model_file.h"
#include "tests/apps/orb360/run_fixture.h"
#include "tests/slam/io/positions/shared_data.h"
#include "tests/slam/scale/gnss_drive.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kScale = 1.02;  // metres in a unit of the run
const GeodeticPoint kOrigin{-33.8568, 151.2153, 20};
const double kStart = *ParseIsoTime("2026-03-14T07:00:00Z");

/// A finished run along a drive, and tracks of receivers that were there.
class GeoreferenceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Projection::IsAvailable()) GTEST_SKIP() << "this build has no PROJ";
    SparseModel model{64, 32, {}, {{{1, 2, 3}, {}}}};
    for (const PathPoint& point : TownDrive()) {
      const auto index = static_cast<int>(model.frames.size());
      model.frames.push_back({index, point.timestamp, 0, true, {}, {{{1, 1}, 0}}});
      model.frames.back().world_from_optical.translation = point.position / kScale;
    }
    std::filesystem::create_directories(folder_ / "run");
    WriteSparseModel(folder_ / "run" / "reconstruction.h5", model);
    WriteText(folder_ / "run" / "summary.json", R"({"input": "drive.mp4", "levelled": true})");
  }

  /// Writes one position a second, from 20 s before the drive to 20 s after it; `distance` is the
  /// length that is driven in a true metre.
  std::string WriteGpx(const std::string& name, double start, double distance = 1) const {
    const Projection local = Projection::Local(kOrigin);
    RandomGeometry random(5);
    std::string text = "<gpx><trk><trkseg>";
    for (double t = -20; t < 140; t += 1) {
      const auto at = Interpolate(TownDrive(), std::clamp(t, 0.0, 120.0), 10);
      const Eigen::Vector3d error(random.Normal(1), random.Normal(1), random.Normal(2));
      const GeodeticPoint place = local.ToGeodetic(distance * at->position + error);
      text += "<trkpt lat=\"" + ToFixedText(place.latitude, 9) + "\" lon=\"" +
              ToFixedText(place.longitude, 9) + "\"><ele>" + ToFixedText(place.height, 3) +
              "</ele><time>" + FormatIsoTime(start + t) + "</time><hdop>0.33</hdop></trkpt>";
    }
    WriteText(folder_ / name, text + "</trkseg></trk></gpx>");
    return folder_ / name;
  }

  ProgramResult Place(const std::string& positions,
                      const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"georeference", folder_ / "run", "--positions",
                                          positions};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunOrb360(arguments);
  }
  /// Exit status 1, one line on standard error, which is returned, and nothing written.
  std::string Refusal(const std::string& positions,
                      const std::vector<std::string>& more = {}) const {
    const ProgramResult result = Place(positions, more);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), testing::StartsWith("orb360: ")));
    EXPECT_FALSE(std::filesystem::exists(Georeferenced()));
    return result.err;
  }
  std::filesystem::path Georeferenced() const { return folder_ / "run" / "georeference.json"; }

  ProgramResult Export(const std::string& format) const {
    return RunOrb360(
        {"export", folder_ / "run", "--to", format, "--out", folder_ / format, "--images", "none"});
  }
  ProgramResult ExportPath(const std::string& format) const {
    return RunOrb360({"export", folder_ / "run", "--to", format, "--out", folder_ / format});
  }

  TempFolder folder_;
};

/// The points of the only line in a file (longitude, latitude, height), as GDAL reads it.
std::vector<Eigen::Vector3d> LineByOgr(const std::filesystem::path& path,
                                       const std::string& layer) {
  std::string text = OutputOf("GPX_ELE_AS_25D=YES ogrinfo -al '" + path.string() + "' " + layer);
  const size_t begin = text.find("LINESTRING Z (");
  if (begin == std::string::npos) return {};
  text = text.substr(text.find_first_of("0123456789-", begin));
  text = text.substr(0, text.find(')'));
  std::vector<Eigen::Vector3d> points;
  std::istringstream numbers(text);
  for (Eigen::Vector3d p; numbers >> p.x() >> p.y() >> p.z(); numbers.ignore(1))
    points.push_back(p);
  return points;
}

TEST_F(GeoreferenceTest, PlacesAFinishedRunByATrackOfAnotherClock) {
  const ProgramResult result = Place(WriteGpx("drive.gpx", kStart));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("placed on Earth by GPX"), HasSubstr("of 160 positions"),
                                HasSubstr("georeference.json")));
  const Georeference georeference = ReadGeoreference(Georeferenced());
  const PositionAlignment& alignment = georeference.alignment;
  EXPECT_NEAR(std::log(alignment.local_from_path.scale / kScale), 0, 3 * alignment.log_scale_sigma);
  EXPECT_LT(alignment.log_scale_sigma, 0.01);
  EXPECT_NEAR(*georeference.utc_at_zero, kStart, 0.3);
  EXPECT_EQ(georeference.altitude_reference, AltitudeReference::kMeanSeaLevel);
}

TEST_F(GeoreferenceTest, AScaleThatIsKnownOtherwiseCountsUnlessItCameFromPositions) {
  const std::string gpx = WriteGpx("drive.gpx", kStart);
  // As if the ground had told a scale that is wrong by 3 %, and far too surely.
  nlohmann::json summary = {{"input", "drive.mp4"},
                            {"levelled", true},
                            {"positions", nullptr},
                            {"scale", {{"value", 1.05}, {"sigma", 1e-5}}}};
  const auto scale = [&] {
    WriteText(folder_ / "run" / "summary.json", summary.dump());
    EXPECT_EQ(Place(gpx).status, 0);
    return ReadGeoreference(Georeferenced()).alignment.local_from_path.scale;
  };
  EXPECT_NEAR(scale(), 1.05, 1e-3);
  // Positions that the run could not use told nothing of its scale.
  summary["positions"] = {{"source", "GPX other.gpx"}, {"failure", "another path"}};
  summary["scale"]["sources"] = {"images of the ground"};
  EXPECT_NEAR(scale(), 1.05, 1e-3);
  summary["scale"]["sources"] = {"images of the ground", "positions"};
  EXPECT_NEAR(scale(), kScale, 0.01);
}

TEST_F(GeoreferenceTest, WhatCannotPlaceTheRunIsRefusedInOneLine) {
  const std::string gpx = WriteGpx("drive.gpx", kStart);
  EXPECT_THAT(Refusal(folder_ / "absent.gpx"), HasSubstr("absent.gpx: no such file or folder"));
  CopyTruncated(gpx, folder_ / "cut.gpx", 0.5);
  EXPECT_THAT(Refusal(folder_ / "cut.gpx"), HasSubstr("cut.gpx: is damaged XML"));
  EXPECT_THAT(Refusal(gpx, {"--utc-start", "noon"}), HasSubstr("--utc-start: `noon` is no time"));
  // Another day.
  EXPECT_THAT(Refusal(gpx, {"--utc-start", "2026-03-13T07:00:00Z"}),
              AllOf(HasSubstr("2026-03-14T06:59:40"), HasSubstr("fewer than 6 of its positions")));
  // A receiver that stands still.
  EXPECT_THAT(Refusal(WriteGpx("still.gpx", kStart, 0)), HasSubstr("do not move far enough"));
}

TEST_F(GeoreferenceTest, ExportsAreReadByGdalWithTheSamePlaces) {
  if (!HasProgram("ogrinfo")) GTEST_SKIP() << "there is no ogrinfo (Debian package gdal-bin)";
  ASSERT_EQ(Place(WriteGpx("drive.gpx", kStart)).status, 0);
  const Georeference georeference = ReadGeoreference(Georeferenced());
  const Projection local = Projection::Local(georeference.origin);
  const std::vector<PathPoint> drive = TownDrive();
  for (const bool has_utc : {true, false}) {
    if (!has_utc) {
      Georeference without = georeference;
      without.utc_at_zero.reset();
      WriteGeoreference(Georeferenced(), without);
    }
    for (const auto& [format, layer] : {std::pair("geojson", ""), {"gpx", "tracks"}, {"kml", ""}}) {
      std::filesystem::remove_all(folder_ / format);
      ASSERT_EQ(ExportPath(format).status, 0) << format;
      const std::filesystem::path path = folder_ / format / (std::string("trajectory.") + format);
      const std::vector<Eigen::Vector3d> line = LineByOgr(path, layer);
      ASSERT_EQ(line.size(), drive.size()) << format;
      for (size_t i = 0; i < drive.size(); ++i) {
        const GeodeticPoint place =
            local.ToGeodetic(georeference.alignment.local_from_path * (drive[i].position / kScale));
        EXPECT_NEAR(line[i].x(), place.longitude, 1e-7) << format;
        EXPECT_NEAR(line[i].y(), place.latitude, 1e-7) << format;
        EXPECT_NEAR(line[i].z(), place.height, 1e-3) << format;
      }
      const std::string text = ReadText(path);
      EXPECT_THAT(text, HasSubstr("mean sea level")) << format;
      const std::string last = FormatIsoTime(*georeference.utc_at_zero + drive.back().timestamp);
      EXPECT_EQ(text.find(last.substr(0, 19)) != std::string::npos, has_utc) << format;
    }
  }
}

TEST_F(GeoreferenceTest, OpensfmGetsTheTopocentricFrame) {
  ASSERT_EQ(Place(WriteGpx("drive.gpx", kStart)).status, 0);
  ASSERT_EQ(Export("opensfm").status, 0);
  const Georeference georeference = ReadGeoreference(Georeferenced());
  const auto reference =
      nlohmann::json::parse(ReadText(folder_ / "opensfm" / "reference_lla.json"));
  EXPECT_EQ(reference["latitude"], georeference.origin.latitude);
  EXPECT_EQ(reference["altitude"], georeference.origin.height);
  const auto model =
      nlohmann::json::parse(ReadText(folder_ / "opensfm" / "reconstruction.json"))[0];
  EXPECT_EQ(model["reference_lla"], reference);
  const nlohmann::json& shot = model["shots"]["000040.jpg"];
  const auto vector = [](const nlohmann::json& json) {
    return Eigen::Vector3d(json[0], json[1], json[2]);
  };
  const Eigen::Vector3d turn = vector(shot["rotation"]);
  const Eigen::Matrix3d camera_from_local =
      Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  const Eigen::Vector3d place = -camera_from_local.transpose() * vector(shot["translation"]);
  const Similarity3& local_from_world = georeference.alignment.local_from_path;
  EXPECT_LT((place - local_from_world * (TownDrive()[40].position / kScale)).norm(), 1e-6);
  const Eigen::Vector3d point = vector(model["points"]["0"]["coordinates"]);
  EXPECT_LT((point - local_from_world * Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
}

TEST_F(GeoreferenceTest, ARunThatIsNotPlacedIsNotExportedInDegrees) {
  for (const char* format : {"geojson", "gpx", "kml"}) {
    const ProgramResult result = ExportPath(format);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("is not placed on Earth"),
                                  HasSubstr("orb360 georeference")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / format));
  }
  WriteText(Georeferenced(), "{");
  const ProgramResult result = ExportPath("gpx");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("georeference.json: is damaged")));
}

}  // namespace
}  // namespace orb360
