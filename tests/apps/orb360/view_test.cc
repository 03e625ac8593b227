#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "slam/io/octree/octree_file.h"
#include "slam/io/ply.h"
#include "slam/io/sparse_model_file.h"
#include "tests/apps/orb360/run_fixture.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The folder of a run as an older version has left it: no reconstruction, no octree.
class ViewTest : public testing::Test {
 protected:
  ViewTest() {
    std::filesystem::create_directory(Run());
    WriteText(File("summary.json"),
              R"({"input": "walk.mp4", "frames": 3, "tracked": 3, "loop_times": [[0.2, 0.0]],)"
              R"( "scale": {"state": "metric", "sigma": 0.02, "value": 1.0}})");
    std::vector<StampedPose> poses(3);
    for (int i = 0; i < 3; ++i) poses[i].timestamp = 0.1 * i;
    WriteTrajectory(File("trajectory.txt"), poses);
    poses.erase(poses.begin() + 1);
    WriteTrajectory(File("keyframes.txt"), poses);
    std::vector<ColoredPoint> points(1000);
    for (int i = 0; i < 1000; ++i) points[i].position = {static_cast<float>(i), 1, 2};
    WritePly(File("cloud.ply"), points);
  }

  std::string Run() const { return folder_ / "run"; }
  std::string File(const std::string& name) const { return Run() + "/" + name; }

  void ExpectRefusal(const std::string& command, const std::string& what) const {
    std::vector<std::string> arguments = {command, Run()};
    if (command == "view") arguments.insert(arguments.end(), {"--port", "0"});
    const ProgramResult result = RunOrb360(arguments);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr(what)));
  }

  const TempFolder folder_;
};

/// `orb360 view` on a port that is free.
class Viewing {
 public:
  explicit Viewing(const std::string& run, const std::vector<std::string>& more = {})
      : program_(Arguments(run, more)) {
    EXPECT_TRUE(program_.WaitForOutput("Ctrl-C"));
  }
  ProgramResult Stop() {
    program_.Signal(SIGINT);
    return program_.Wait();
  }

 private:
  static std::vector<std::string> Arguments(const std::string& run,
                                            const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"view", run, "--port", "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  Program program_;
};

TEST_F(ViewTest, MakesTheOctreeOfAnOlderRunAndSaysWhatIsMissing) {
  Viewing viewing(Run());
  const ProgramResult result = viewing.Stop();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("http://127.0.0.1:"), HasSubstr("levels of detail"),
                    HasSubstr("not there: Keyframe graph"), HasSubstr("not there: Dense cloud")));
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_EQ(OctreeFile(File("cloud.octree")).header().point_count, 1000U);
}

TEST_F(ViewTest, MakesTheOctreeAnewWhereTheCloudIsNewer) {
  Viewing(Run()).Stop();
  WritePly(File("cloud.ply"), std::vector<ColoredPoint>(10));
  std::filesystem::last_write_time(
      File("cloud.ply"), std::filesystem::file_time_type::clock::now() + std::chrono::seconds(2));
  Viewing(Run()).Stop();
  EXPECT_EQ(OctreeFile(File("cloud.octree")).header().point_count, 10U);
}

TEST_F(ViewTest, ShowsAPathWithoutACloud) {
  std::filesystem::remove(File("cloud.ply"));
  Viewing viewing(Run());
  const ProgramResult result = viewing.Stop();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("not there: Points"));
}

TEST_F(ViewTest, SaysThatAPortIsTaken) {
  Program first({"view", Run(), "--port", "0"});
  ASSERT_TRUE(first.WaitForOutput("Ctrl-C"));
  first.Signal(SIGTERM);
  const ProgramResult told = first.Wait();
  EXPECT_EQ(told.status, 0);
  const size_t at = told.out.find("127.0.0.1:") + 10;
  const std::string port = told.out.substr(at, told.out.find('/', at) - at);
  Program second({"view", Run(), "--port", port});
  ASSERT_TRUE(second.WaitForOutput("Ctrl-C"));  // It is free again at once.
  const ProgramResult refused = RunOrb360({"view", Run(), "--port", port});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err,
              AllOf(IsOneLine(), HasSubstr("port " + port + " is taken"), HasSubstr("--port")));
}

TEST_F(ViewTest, RefusesFoldersWithoutARunAndDamagedFiles) {
  Viewing(Run()).Stop();
  const std::string octree = ReadText(File("cloud.octree"));
  WriteText(File("cloud.octree"), octree.substr(0, 5000));
  std::filesystem::last_write_time(
      File("cloud.octree"),
      std::filesystem::file_time_type::clock::now() + std::chrono::seconds(2));
  for (const char* command : {"view", "report"}) {
    ExpectRefusal(command, "cloud.octree: is truncated");
  }
  std::filesystem::remove(File("cloud.octree"));
  WriteText(File("cloud.ply"), "ply\nnothing");
  ExpectRefusal("view", "cloud.ply");
  WriteText(File("summary.json"), R"({"scale": {"state": 5}})");
  ExpectRefusal("view", "summary.json: is damaged");
  WriteText(File("summary.json"), R"({"input": 7})");
  ExpectRefusal("report", "summary.json: is damaged");
  WriteText(File("summary.json"), "{\"input\": ");
  ExpectRefusal("view", "summary.json: is damaged");
  std::filesystem::remove(File("summary.json"));
  ExpectRefusal("report", "holds no finished run");
  std::filesystem::remove_all(Run());
  ExpectRefusal("view", "is no folder");
}

TEST_F(ViewTest, ShowsWhatItCanWhereViewsOrTrajectoryCannotBeUsed) {
  WriteText(File("trajectory.txt"), "0.1 no pose\n");
  const ProgramResult older = Viewing(Run()).Stop();
  EXPECT_EQ(older.status, 0) << older.err;
  EXPECT_THAT(older.out, HasSubstr("not there: Trajectory: " + File("trajectory.txt")));
  SparseModel model;
  model.width = 100;
  model.height = 50;
  WriteSparseModel(File("reconstruction.h5"), model);
  std::filesystem::create_directory(File("views"));
  for (const char* content : {"", R"({"version": 99})"}) {
    if (*content != '\0') WriteText(File("views/views.json"), content);
    const ProgramResult result = Viewing(Run()).Stop();
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("not there: Images and ranges of keyframes: " +
                                      File("views/views.json")));
  }
}

TEST_F(ViewTest, ShowsAReadOnlyFolderWithoutItsPoints) {
  std::filesystem::permissions(folder_ / "", std::filesystem::perms(0755));
  std::filesystem::permissions(Run(), std::filesystem::perms(0555));
  // Permissions do not hold for root: its children are somebody else.
  const uid_t user = geteuid();
  constexpr uid_t kNobody = 65534;
  ASSERT_TRUE(user != 0 || seteuid(kNobody) == 0);
  if (faccessat(AT_FDCWD, ORB360_BINARY_DIR "/orb360", X_OK, AT_EACCESS) != 0) {
    ASSERT_TRUE(user != 0 || seteuid(user) == 0);
    GTEST_SKIP() << "others than root may not run the program that was built here";
  }
  Viewing viewing(Run());
  const ProgramResult result = viewing.Stop();
  ASSERT_TRUE(user != 0 || seteuid(user) == 0);
  std::filesystem::permissions(Run(), std::filesystem::perms(0755));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("not there: Points: the folder cannot be written to"));
  EXPECT_FALSE(std::filesystem::exists(File("cloud.octree")));
}

TEST_F(ViewTest, LeavesNothingWhenInterruptedWhileItMakesTheOctree) {
  std::vector<ColoredPoint> points(4'000'000);
  for (int i = 0; i < 4'000'000; ++i)
    points[i].position = {static_cast<float>(i % 2000), i / 2e3f, 2};
  WritePly(File("cloud.ply"), points);
  Program program({"view", Run(), "--port", "0"});
  ASSERT_TRUE(program.WaitForOutput("levels of detail"));
  program.Signal(SIGINT);
  const ProgramResult result = program.Wait();
  EXPECT_EQ(result.status, 128 + SIGINT);
  EXPECT_THAT(result.out, testing::Not(HasSubstr("http")));
  for (const auto& entry : std::filesystem::directory_iterator(Run())) {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("octree")));
  }
}

/// Moving poses, 0.1 s apart, along a bend.
std::vector<StampedPose> MovingPoses() {
  std::vector<StampedPose> poses(30);
  for (int i = 0; i < 30; ++i) {
    poses[i].timestamp = 0.1 * i;
    poses[i].world_from_camera.translation = {0.2 * i, 0.01 * i * i, 0};
  }
  return poses;
}

TEST_F(ViewTest, ComparesWithAnotherRunWithGroundTruthAndWithATrajectory) {
  WriteTrajectory(File("trajectory.txt"), MovingPoses());
  std::filesystem::copy(Run(), folder_ / "other");
  std::filesystem::create_directory(folder_ / "sequence");
  WriteTrajectory(folder_ / "sequence/groundtruth.txt", MovingPoses());
  WriteTrajectory(folder_ / "path.txt", MovingPoses());
  for (const char* name : {"other", "sequence", "path.txt"}) {
    const ProgramResult result = Viewing(Run(), {"--compare", folder_ / name}).Stop();
    EXPECT_EQ(result.status, 0) << result.err;
  }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "other/cloud.octree"));
  const ProgramResult report =
      RunOrb360({"report", Run(), "--out", folder_ / "r.html", "--compare", folder_ / "other"});
  EXPECT_EQ(report.status, 0) << report.err;
  const std::string page = ReadText(folder_ / "r.html");
  EXPECT_THAT(page, AllOf(HasSubstr("\"isRigid\":true"), HasSubstr("\"hasCloud\":false")));
}

TEST_F(ViewTest, RefusesToCompareWithWhatIsNoPathOrHasOtherTimes) {
  WriteTrajectory(File("trajectory.txt"), MovingPoses());
  const auto expect_refusal = [&](const std::string& other, const std::string& what) {
    for (const char* command : {"view", "report"}) {
      std::vector<std::string> arguments = {command, Run(), "--compare", other};
      if (arguments.front() == "view") arguments.insert(arguments.end(), {"--port", "0"});
      const ProgramResult result = RunOrb360(arguments);
      EXPECT_EQ(result.status, 1);
      EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr(what)));
    }
  };
  expect_refusal(folder_ / "absent", "absent: no such file or folder");
  std::filesystem::create_directory(folder_ / "empty");
  expect_refusal(folder_ / "empty", "neither a finished run (summary.json) nor ground truth");
  WriteText(folder_ / "words.txt", "no pose\n");
  expect_refusal(folder_ / "words.txt", "words.txt");
  std::vector<StampedPose> later = MovingPoses();
  for (StampedPose& pose : later) pose.timestamp += 1000;
  WriteTrajectory(folder_ / "later.txt", later);
  expect_refusal(folder_ / "later.txt", "cannot be aligned with " + Run());
  std::filesystem::create_directory(folder_ / "damaged");
  WriteText(folder_ / "damaged/summary.json", "{");
  expect_refusal(folder_ / "damaged", "summary.json: is damaged");
}

TEST_F(ViewTest, HasATokenWhenOpenedBeyondThisMachine) {
  Viewing viewing(Run(), {"--view-address", "0.0.0.0"});
  const ProgramResult result = viewing.Stop();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, testing::ContainsRegex("http://[^/]+/[0-9a-f]+/"));
}

TEST_F(ViewTest, ReportIsOneFileOfTheSizeAskedFor) {
  std::vector<ColoredPoint> points(400000);
  for (int i = 0; i < 400000; ++i) {
    const int row = i / 700;
    points[i].position = {static_cast<float>(i % 700), static_cast<float>(row), 2};
  }
  WritePly(File("cloud.ply"), points);
  const ProgramResult result =
      RunOrb360({"report", Run(), "--out", folder_ / "r.html", "--max-size", "3"});
  EXPECT_EQ(result.status, 0) << result.err;
  const std::uintmax_t size = std::filesystem::file_size(folder_ / "r.html");
  EXPECT_LE(size, 3'000'000U);
  EXPECT_GE(size, 2'700'000U);
  const std::string page = ReadText(folder_ / "r.html");
  EXPECT_THAT(page, HasSubstr("embedded-octree"));
  EXPECT_THAT(page, HasSubstr("walk.mp4"));
  EXPECT_THAT(page, HasSubstr(" of 400000 points"));
}

TEST_F(ViewTest, ReportHoldsItsSizeWithoutACloudAsWell) {
  std::filesystem::remove(File("cloud.ply"));
  std::vector<StampedPose> poses(40000);
  for (int i = 0; i < 40000; ++i) {
    poses[i].timestamp = 0.1 * i;
    poses[i].world_from_camera.translation = {0.12345 * i, 0.54321 * i, 1.23456};
  }
  WriteTrajectory(File("trajectory.txt"), poses);
  const auto report = [&](const char* max_size) {
    return RunOrb360({"report", Run(), "--out", folder_ / "r.html", "--max-size", max_size});
  };
  const ProgramResult refused = report("2");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, AllOf(IsOneLine(), HasSubstr("--max-size: 2 MB have no room for")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r.html"));
  const ProgramResult written = report("10");
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_GT(std::filesystem::file_size(folder_ / "r.html"), 2'000'000U);
}

}  // namespace
}  // namespace orb360
