#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

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

class TownCommandTest : public testing::Test {
 protected:
  TownCommandTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("town_command_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~TownCommandTest() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string Out() const { return " --out " + (folder_ / "out").string(); }
  /// Runs `arguments`, which must be refused in one line with `problem` in it, leaving nothing.
  void ExpectRefused(const std::string& arguments, const std::string& problem) const {
    const Outcome outcome = RunTown(arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.output, testing::StartsWith("town: ")) << arguments;
    EXPECT_THAT(outcome.output, testing::HasSubstr(problem)) << arguments;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/rgb")) << arguments;
  }
  /// A wall 2 m wide and high at x = 0, y up, as the file has it.
  std::string Wall() const {
    return Write("wall.obj", "v 0 0 -1\nv 0 0 1\nv 0 2 1\nv 0 2 -1\nf 1 2 3 4\n");
  }

  std::filesystem::path folder_;
};

TEST_F(TownCommandTest, AnswersBadTownsWithOneLine) {
  ExpectRefused(
      "render --town Atlantis" + Out(),
      "unknown town 'Atlantis': use Town1 ... Town5, Loop, or a seed of at most 18 digits");
  ExpectRefused("describe Town1 Town9", "unknown town 'Town9'");
  ExpectRefused("render --town 1 --light dusk" + Out(),
                "unknown light 'dusk': use noon, morning, sunset or overcast");
  ExpectRefused("render" + Out(), "one of --town, --interior, --landscape, --tunnel and --scene");
  ExpectRefused("render --interior Cellar" + Out(), "unknown interior 'Cellar': use a seed");
  ExpectRefused("render --interior 1 --traffic 1" + Out(), "--traffic is for a --town");
  ExpectRefused("render --interior 1 --light dusk" + Out(), "unknown light 'dusk'");
  ExpectRefused("render --interior 1 --town 1" + Out(), "one of --town");
  ExpectRefused("render --landscape 1 --tunnel 1" + Out(), "one of --town");
  ExpectRefused("render --landscape wood" + Out(), "unknown landscape 'wood'");
  ExpectRefused("render --tunnel -3" + Out(), "unknown tunnel '-3'");
  ExpectRefused("render --tunnel 1 --light noon" + Out(), "--light is for worlds under a sky");
  ExpectRefused("render --tunnel 1 --traffic 0.5" + Out(), "nothing moves in other worlds");
  ExpectRefused("render --town 1 --path " + Write("p.txt", "0 1 2 3\n1 1 2 4\n") + Out(),
                "--path is for a --scene");
  ExpectRefused("render --town 1 --out /dev/null/x", "/dev/null is a file");
}

TEST_F(TownCommandTest, AnswersBadNumbers) {
  for (const char* option : {"--frames 0", "--traffic 2", "--width 33", "--width 40000",
                             "--samples 3", "--jpeg-quality 101"}) {
    const Outcome outcome = RunTown(std::string("render --town 1 ") + option + Out());
    EXPECT_NE(outcome.status, 0) << option;
    EXPECT_THAT(outcome.output, testing::HasSubstr(std::string(option).substr(0, 4))) << option;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(TownCommandTest, AnswersBadScenesWithOneLine) {
  const std::string path = " --path " + Write("path.txt", "0 5 5 1\n2 7 5 1\n") + Out();
  ExpectRefused("render --scene " + Wall() + Out(), "--scene needs a --path");
  ExpectRefused("render --scene " + Wall() + Out() + " --path " + Write("none.txt", ""),
                "none.txt: ");
  ExpectRefused("render --scene " + Wall() + Out() + " --path " + (folder_ / "no.txt").string(),
                "no.txt: ");
  ExpectRefused("render --scene " + Wall() + " --light dusk" + path, "unknown light 'dusk'");
  ExpectRefused("render --scene " + (folder_ / "no.obj").string() + path, "no.obj: no such file");
  ExpectRefused("render --scene " + folder_.string() + path, "is a folder");
  for (const char* name : {"empty.obj", "empty.ac", "empty.glb", "empty.gltf", "empty.xyz"})
    ExpectRefused("render --scene " + Write(name, "") + path, std::string(name) + ": ");
  for (const char* name : {"bad.obj", "bad.ac", "bad.glb", "bad.gltf"})
    ExpectRefused("render --scene " + Write(name, "f 1 2 nonsense\n{{{") + path,
                  std::string(name) + ": ");
  ExpectRefused("render --width 64 --scene " + Wall() + Out() + " --path " +
                    Write("through.txt", "0 -3 0 1\n1 3 0 1\n"),
                "goes through");
}

TEST_F(TownCommandTest, AnswersBadCircuitsAndRecordingsWithOneLine) {
  const std::string path_out = " --out " + (folder_ / "path.txt").string();
  ExpectRefused("path --torcs " + (folder_ / "no.acc").string() + path_out, "no.acc: no such file");
  ExpectRefused("path --torcs " + Wall() + path_out, "has no ring of road");
  ExpectRefused("path" + path_out, "one of --torcs, --kart and --walk");
  ExpectRefused("path --walk 1 --laps 2 --scene " + Wall() + path_out, "--laps is for");
  ExpectRefused("path --walk 1 --scene " + Wall() + path_out,
                "wall.obj: nobody can walk here: there is no floor");
  ExpectRefused("path --walk 1 --scene " + Wall() + " --start 900,0,0" + path_out,
                "wall.obj: the start is outside");
  ExpectRefused("path --walk 1 --scene " + Write("cut.bsp", "IBSP") + path_out,
                "cut.bsp: is damaged");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "path.txt"));
  ExpectRefused("stitch " + folder_.string() + Out(), "front: no such folder");
  ExpectRefused("stitch " + (folder_ / "nowhere").string() + Out(), "front: no such folder");
}

TEST_F(TownCommandTest, WalksAreRendered) {
  const std::string scene =
      Write("floor.obj", "v 0 0 0\nv 20 0 0\nv 20 0 -20\nv 0 0 -20\nf 1 2 3 4\n");
  const std::string path = (folder_ / "walk.txt").string();
  EXPECT_EQ(RunTown("path --walk 7 --length 10 --scene " + scene + " --out " + path).status, 0);
  EXPECT_EQ(
      RunTown("render --width 64 --fps 2 --scene " + scene + " --path " + path + Out()).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/rgb/000016.jpg"));  // 10 m at 1.2 m/s
}

TEST_F(TownCommandTest, AnswersAFullDiskWithOneLine) {
  // A limit on the size of files stands in for the disk: 20 kB hold the texts but no image.
  const std::string scene = " --scene " + Wall() + " --path " +
                            Write("path.txt", "0 5 5 1\n2 7 5 1\n") + " --frames 3 --width 512";
  FILE* pipe = popen(
      ("trap '' XFSZ; ulimit -f 20; " ORB360_BINARY_DIR "/town render" + scene + Out() + " 2>&1")
          .c_str(),
      "r");
  std::array<char, 512> line{};
  ASSERT_NE(fgets(line.data(), line.size(), pipe), nullptr);
  EXPECT_THAT(line.data(), testing::HasSubstr("cannot be written"));
  EXPECT_EQ(fgets(line.data(), line.size(), pipe), nullptr);
  EXPECT_EQ(WEXITSTATUS(pclose(pipe)), 1);
  // With space again it goes on, and nothing half-written is left.
  EXPECT_EQ(RunTown("render" + scene + Out()).status, 0);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".tmp");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/rgb/000002.jpg"));
}

}  // namespace
