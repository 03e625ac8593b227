#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/orb360/program.h"
#include <orb360/slam/version.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(CommandLine, TellsItsVersion) {
  const ProgramResult result = RunOrb360({"--version"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "orb360 " + std::string(Version()) + "\n");
}

TEST(CommandLine, ExplainsItself) {
  const ProgramResult result = RunOrb360({"run", "--help"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("INPUT"), HasSubstr("--out")));
  EXPECT_THAT(result.err, IsEmpty());
}

TEST(CommandLine, AMistakeIsOneLineThatNamesItAndWhereToReadMore) {
  const auto error = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = RunOrb360(arguments);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err, StartsWith("orb360: "));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(error({}), HasSubstr("subcommand"));
  EXPECT_THAT(error({"run"}), AllOf(HasSubstr("INPUT"), HasSubstr("orb360 run --help")));
  EXPECT_THAT(error({"run", "a.mp4"}), HasSubstr("--out"));
  EXPECT_THAT(error({"run", "a.mp4", "--out", "b", "--stride", "0"}), HasSubstr("--stride"));
  EXPECT_THAT(error({"run", "a.mp4", "--out", "b", "--max-frames", "x"}),
              HasSubstr("--max-frames"));
  EXPECT_THAT(error({"run", "a.mp4", "--out", "b", "--colour"}), HasSubstr("--colour"));
  EXPECT_THAT(error({"evaluate", "a"}), HasSubstr("ESTIMATE"));
}

TEST(CommandLine, ConfigPrintsAFileThatRunAccepts) {
  const ProgramResult result = RunOrb360({"config"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("features:"), HasSubstr("  count: 2000"),
                                HasSubstr("tracker:"), HasSubstr("  # ")));
  const TempFolder folder;
  WriteText(folder / "c.yaml", result.out);
  // The configuration is read first, so the input is what is wrong.
  EXPECT_THAT(
      RunOrb360({"run", folder / "absent", "--out", folder / "out", "--config", folder / "c.yaml"})
          .err,
      HasSubstr("absent: no such file"));
}

}  // namespace
}  // namespace orb360
