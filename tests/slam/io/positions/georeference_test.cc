#include "slam/io/positions/georeference.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/positions/utc_time.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/scale/gnss_drive.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

const GeodeticPoint kOrigin{47.3769, 8.5417, 408};
constexpr double kScale = 2.5;  // metres in a unit of the path
const Similarity3 kLocalFromPath{
    kScale, Eigen::Quaterniond(Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ())), {40, -70, 3}};

std::vector<PathPoint> Path() {
  std::vector<PathPoint> path = TownDrive();
  for (PathPoint& point : path) point.position /= kScale;
  return path;
}

// A GPX track that begins before the path and ends after it.
PositionTrack Track(double sigma, double start) {
  RandomGeometry random(3);
  std::vector<PathPoint> whole = Path();
  for (PathPoint& point : whole) point.position = kLocalFromPath * point.position;
  const Projection local = Projection::Local(kOrigin);
  PositionTrack track;
  track.source = "GPX drive.gpx";
  track.clock = PositionClock::kUtc;
  track.utc_at_zero = 0.0;
  track.altitude_reference = AltitudeReference::kMeanSeaLevel;
  for (double t = -100; t < 200; t += 1) {
    // Before and after the path the receiver stands still.
    const auto at = Interpolate(whole, std::clamp(t, 0.0, 120.0), 10);
    Eigen::Vector3d error;
    for (double& element : error) element = random.Normal(sigma);
    const GeodeticPoint place = local.ToGeodetic(at->position + error);
    track.fixes.push_back({start + t, place.latitude, place.longitude, place.height, {}, {}});
  }
  return track;
}

class GeoreferenceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Projection::IsAvailable()) GTEST_SKIP() << "this build has no PROJ";
  }
};

TEST_F(GeoreferenceTest, PlacesAPathByATrackOnAnotherClock) {
  const double start = *ParseIsoTime("2025-03-14T07:00:00Z");
  const std::vector<PathPoint> path = Path();
  const Georeference georeference =
      PlaceOnEarth(path, Track(3.0, start), {{Eigen::Vector3d::UnitZ(), kGroundUpSigma}, {}, {}});
  EXPECT_NEAR(*georeference.utc_at_zero, start, 0.5);
  const PositionAlignment& alignment = georeference.alignment;
  EXPECT_NEAR(alignment.local_from_path.scale / kScale, 1, 0.01);
  // The truth goes through another origin, so that both frames have to be right.
  const Projection truth = Projection::Local(kOrigin);
  const Projection local = Projection::Local(georeference.origin);
  std::vector<double> distances;
  for (const PathPoint& point : path) {
    const GeodeticPoint place = local.ToGeodetic(alignment.local_from_path * point.position);
    distances.push_back(
        (truth.FromGeodetic(place) - kLocalFromPath * point.position).head<2>().norm());
  }
  std::ranges::nth_element(distances, distances.begin() + distances.size() / 2);
  EXPECT_LT(distances[distances.size() / 2], 1.0);
}

TEST_F(GeoreferenceTest, TakesTheTimeOfTheFirstFrameFromTheUser) {
  const double start = *ParseIsoTime("2025-03-14T07:00:00Z");
  const PathKnowledge known{{}, {}, start + 0.4};
  EXPECT_NEAR(*PlaceOnEarth(Path(), Track(1.0, start), known).utc_at_zero, start, 0.3);
  const PathKnowledge wrong{{}, {}, start + 3600};
  EXPECT_THAT(
      MessageOf<UserError>([&] { PlaceOnEarth(Path(), Track(1.0, start), wrong); }),
      testing::AllOf(testing::HasSubstr("fewer than 6 of its positions, from 2025-03-14T06:58"),
                     testing::HasSubstr("lie on the path of 120 s")));
}

// A receiver that has no time yet writes 1970, others a date of the future.
TEST_F(GeoreferenceTest, StrayTimesNeitherRefuseTheTrackNorTakeMemory) {
  const double start = *ParseIsoTime("2025-03-14T07:00:00Z");
  PositionTrack track = Track(1.0, start);
  GeodeticFix stray = track.fixes.front();
  stray.timestamp = 0;
  track.fixes.insert(track.fixes.begin(), stray);
  stray.timestamp = 7e9;
  track.fixes.push_back(stray);
  EXPECT_NEAR(*PlaceOnEarth(Path(), track, {}).utc_at_zero, start, 0.3);
  EXPECT_NEAR(*PlaceOnEarth(Path(), track, {{}, {}, start + 0.4}).utc_at_zero, start, 0.3);
}

TEST_F(GeoreferenceTest, ImagesManySecondsApartArePlacedByTheirOwnPositions) {
  std::vector<PathPoint> path = Path();
  PositionTrack track = Track(0.1, 0.0);
  track.clock = PositionClock::kFrames;
  track.utc_at_zero.reset();
  const auto is_between = [](double time) { return time != 10 * std::round(time / 10); };
  std::erase_if(path, [&](const PathPoint& point) { return is_between(point.timestamp); });
  std::erase_if(track.fixes, [&](const GeodeticFix& fix) { return is_between(fix.timestamp); });
  ASSERT_EQ(path[1].timestamp - path[0].timestamp, 10);
  const Georeference georeference = PlaceOnEarth(path, track, {});
  EXPECT_NEAR(georeference.alignment.local_from_path.scale / kScale, 1, 0.01);
  EXPECT_EQ(georeference.alignment.num_fixes, static_cast<int>(path.size()));
}

TEST_F(GeoreferenceTest, IsWhatItWasAfterItHasBeenWritten) {
  Georeference georeference = PlaceOnEarth(Path(), Track(3.0, 1e9), {});
  const TempFolder folder;
  for (const bool has_height : {true, false}) {
    if (!has_height) {
      georeference.alignment.vertical_sigma = std::numeric_limits<double>::infinity();
      georeference.utc_at_zero.reset();
    }
    WriteGeoreference(folder / "a.json", georeference);
    const Georeference back = ReadGeoreference(folder / "a.json");
    EXPECT_EQ(back.origin.latitude, georeference.origin.latitude);
    EXPECT_EQ(back.alignment.local_from_path.translation,
              georeference.alignment.local_from_path.translation);
    EXPECT_EQ(back.alignment.local_from_path.scale, georeference.alignment.local_from_path.scale);
    EXPECT_EQ(back.alignment.vertical_sigma, georeference.alignment.vertical_sigma);
    EXPECT_NEAR(back.alignment.heading_sigma, georeference.alignment.heading_sigma, 1e-12);
    EXPECT_EQ(back.altitude_reference, AltitudeReference::kMeanSeaLevel);
    EXPECT_EQ(back.utc_at_zero.has_value(), has_height);
    if (has_height) {
      EXPECT_NEAR(*back.utc_at_zero, *georeference.utc_at_zero, 0.001);
    }
  }
}

TEST_F(GeoreferenceTest, DamagedFilesAreRefusedInOneLine) {
  const TempFolder folder;
  const Georeference georeference = PlaceOnEarth(Path(), Track(3.0, 1e9), {});
  WriteGeoreference(folder / "a.json", georeference);
  const std::string whole = ReadText(folder / "a.json");
  const auto refusal = [&](const std::string& text) {
    WriteText(folder / "b.json", text);
    return MessageOf<UserError>([&] { ReadGeoreference(folder / "b.json"); });
  };
  EXPECT_THAT(MessageOf<UserError>([&] { ReadGeoreference(folder / "none.json"); }),
              testing::HasSubstr("orb360 georeference"));
  EXPECT_THAT(refusal(whole.substr(0, whole.size() / 2)), testing::HasSubstr("is damaged"));
  EXPECT_THAT(refusal("[]"), testing::HasSubstr("is damaged"));
  std::string far = whole;
  far.replace(far.find("\"latitude\": ") + 12, 1, "9999");
  EXPECT_THAT(refusal(far), testing::HasSubstr("is damaged"));
  std::string other = whole;
  other.replace(other.find("\"version\": 1") + 11, 1, "7");
  EXPECT_THAT(refusal(other), testing::HasSubstr("another version"));
}

}  // namespace
}  // namespace orb360
