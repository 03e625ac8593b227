#include <array>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

namespace {

struct Outcome {
  int status = 0;
  std::string output;
};

Outcome RunTown(const std::string& arguments) {
  FILE* pipe = popen((ORB360_BINARY_DIR "/town " + arguments + " 2>&1").c_str(), "r");
  Outcome outcome;
  std::array<char, 256> buffer;
  while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.output += buffer.data();
  outcome.status = WEXITSTATUS(pclose(pipe));
  return outcome;
}

TEST(TownCommand, AnswersBadInputWithOneLine) {
  const Outcome town = RunTown("render --town Atlantis --out /nowhere/at/all");
  EXPECT_EQ(town.status, 1);
  EXPECT_EQ(
      town.output,
      "town: unknown town 'Atlantis': use Town1 ... Town5, Loop, or a seed of at most 18 digits\n");
  const Outcome light = RunTown("render --town 1 --light dusk --out /nowhere/at/all");
  EXPECT_EQ(light.status, 1);
  EXPECT_EQ(light.output, "town: unknown light 'dusk': use noon, morning, sunset or overcast\n");
  EXPECT_NE(RunTown("render --town 1 --out x --frames 0").status, 0);
  EXPECT_NE(RunTown("render --town 1 --out x --traffic 2").status, 0);
  EXPECT_THAT(RunTown("render --out x").output, testing::HasSubstr("either --town or --scene"));
}

}  // namespace
