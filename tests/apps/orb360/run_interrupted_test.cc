#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/run_fixture.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(RunTest, AFullDiskEndsInOneLineAndKeepsWhatFits) {
  WriteRoom();
  const ProgramResult result =
      Program({"run", Input(), "--out", Out(), "--threads", "1", "--weights", "none"}, 8000).Wait();
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("cloud.ply"), HasSubstr("free some space")));
  EXPECT_EQ(PosesIn("trajectory.txt"), static_cast<size_t>(kFrames));
  EXPECT_FALSE(std::filesystem::exists(OutFile("cloud.ply.tmp")));
}

TEST_F(RunTest, AFullDiskTakesTheCloudAndNotTheTrajectory) {
  WriteRoom();
  WriteMeanNetwork(folder_ / "net.h5");
  const ProgramResult result =
      Program({"run", Input(), "--out", Out(), "--threads", "1", "--weights", folder_ / "net.h5"},
              8000)
          .Wait();
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("free some space")));
  EXPECT_EQ(PosesIn("trajectory.txt"), static_cast<size_t>(kFrames));
  EXPECT_FALSE(std::filesystem::exists(OutFile("depth.tmp")));
}

/// A run long enough to be disturbed: the same walk to and fro.
class InterruptedRunTest : public RunTest {
 protected:
  static constexpr int kLongRun = 2000;

  InterruptedRunTest() {
    WriteRoom();
    constexpr int kPeriod = 2 * kFrames - 2;
    for (int i = kFrames; i < kLongRun; ++i) {
      const int phase = i % kPeriod;
      std::filesystem::create_hard_link(Image(std::min(phase, kPeriod - phase)), Image(i));
    }
  }

  /// Starts a run and returns once the first pose is known.
  std::unique_ptr<Program> Start() const {
    auto program = std::make_unique<Program>(std::vector<std::string>{
        "run", Input(), "--out", Out(), "--threads", "1", "--weights", "none"});
    EXPECT_TRUE(program->WaitForOutput("first map made"));
    return program;
  }
};

TEST_F(InterruptedRunTest, CtrlCWritesWhatWasDone) {
  const std::unique_ptr<Program> program = Start();
  program->Signal(SIGINT);
  const ProgramResult result = program->Wait();
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("interrupted"), HasSubstr(Out())));
  const nlohmann::json summary = Summary();
  EXPECT_EQ(summary["interrupted"], true);
  EXPECT_LT(summary["frames"], kLongRun);
  EXPECT_EQ(PosesIn("trajectory.txt"), summary["tracked"]);
  EXPECT_GE(summary["tracked"], 2);
  EXPECT_FALSE(std::filesystem::exists(OutFile("trajectory.journal")));
}

TEST_F(InterruptedRunTest, TerminationWritesWhatWasDoneToo) {
  const std::unique_ptr<Program> program = Start();
  program->Signal(SIGTERM);
  EXPECT_EQ(program->Wait().status, 143);
  EXPECT_EQ(PosesIn("trajectory.txt"), Summary()["tracked"]);
}

TEST_F(InterruptedRunTest, AKilledRunLeavesTheJournal) {
  const std::unique_ptr<Program> program = Start();
  program->Signal(SIGKILL);
  EXPECT_EQ(program->Wait().status, 128 + SIGKILL);
  EXPECT_GE(PosesIn("trajectory.journal"), 1u);
  EXPECT_FALSE(std::filesystem::exists(OutFile("trajectory.txt")));
}

}  // namespace
}  // namespace orb360
