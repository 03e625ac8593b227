// Towns that are rendered while they are tracked.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "slam/io/atomic_file.h"
#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/run_fixture.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(RunTown, RendersATownWhileTrackingIt) {
  const TempFolder folder;
  const ProgramResult result =
      RunOrb360({"run", "town:Loop", "--out", folder / "out", "--resize", "512x256", "--max-frames",
                 "15", "--quiet", "--weights", "none"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  EXPECT_EQ(summary["frames"], 15);
  EXPECT_EQ(summary["input"], "town:Loop");
  const std::vector<StampedPose> poses = ReadTrajectory(folder / "out/trajectory.txt");
  ASSERT_EQ(poses.size(), 15u);
  EXPECT_NEAR(poses[1].timestamp - poses[0].timestamp, 0.05, 1e-9);
}

TEST(RunTown, TakesNoScaleFromWhatTheNetworkDoesNotTakeForGround) {
  const TempFolder folder;
  for (const double probability : {0.3, 0.9}) {
    WriteMeanNetwork(folder / "net.h5", probability);
    const ProgramResult result =
        RunOrb360({"run", "town:Loop", "--out", folder / "out", "--resize", "512x256",
                   "--max-frames", "12", "--weights", folder / "net.h5"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto scale = nlohmann::json::parse(ReadText(folder / "out/summary.json"))["scale"];
    EXPECT_NEAR(scale["ground_probability"].get<double>(), probability, 1e-6);
    EXPECT_EQ(scale["state"], probability < 0.4 ? "unknown" : "metric");
    EXPECT_EQ(scale["sources"].empty(), probability < 0.4);
    EXPECT_EQ(result.out.find("is it on its side?") != std::string::npos, probability < 0.4)
        << result.out;
  }
}

TEST(RunTown, NamesATownThatDoesNotExist) {
  const TempFolder folder;
  const ProgramResult result = RunOrb360({"run", "town:Nowhere", "--out", folder / "out"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("Nowhere"), HasSubstr("Town1")));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
}

}  // namespace
}  // namespace orb360
