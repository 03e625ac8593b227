#include <filesystem>
#include <string>
#include <vector>

#include "slam/io/octree/octree_file.h"
#include "slam/io/ply.h"
#include "tests/apps/orb360/run_fixture.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A run whose views were saved.
class FuseTest : public RunTest {
 protected:
  FuseTest() {
    WriteRoom();
    WriteMeanNetwork(folder_ / "net.h5");
    // A point must be seen by three keyframes; the room is small and the way short.
    WriteText(folder_ / "dense.yaml", "keyframe:\n  max_motion: 0.02\n");
    const ProgramResult result = Run({"--weights", folder_ / "net.h5", "--config",
                                      folder_ / "dense.yaml", "--save-views", "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
  }

  ProgramResult Fuse(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"fuse", Out()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunOrb360(arguments);
  }

  void ExpectRefusal(const std::string& what) const {
    const ProgramResult result = Fuse();
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr(what)));
  }
};

TEST_F(FuseTest, WritesTheBytesOfTheRunForAnyNumberOfThreads) {
  const std::string cloud = ReadText(OutFile("cloud.ply"));
  std::filesystem::remove(OutFile("cloud.ply"));
  const ProgramResult result = Fuse({"--threads", "2"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("points of"));
  EXPECT_EQ(ReadText(OutFile("cloud.ply")), cloud);
  EXPECT_FALSE(std::filesystem::exists(OutFile("cloud.ply.voxels")));
}

TEST_F(FuseTest, StandsBesideAnOctreeOfAllPointsThatTheRunWrote) {
  const OctreeFile octree(OutFile("cloud.octree"));
  EXPECT_EQ(octree.header().point_count, ReadSurfacePly(OutFile("cloud.ply")).size());
  EXPECT_EQ(octree.header().attributes, kOctreeNormals | kOctreeConfidences);
}

TEST_F(FuseTest, WritesTheSurfaceThroughTheCloudOnRequest) {
  EXPECT_FALSE(std::filesystem::exists(OutFile("mesh.ply")));
  const ProgramResult result = Fuse({"--mesh", "--threads", "2"});
  EXPECT_EQ(result.status, 0) << result.err;
  const std::string mesh = ReadText(OutFile("mesh.ply"));
  EXPECT_GT(mesh.size(), 10000u);
  EXPECT_EQ(Fuse({"--mesh", "--threads", "1"}).status, 0);
  EXPECT_EQ(ReadText(OutFile("mesh.ply")), mesh);
  EXPECT_FALSE(std::filesystem::exists(OutFile("mesh.ply.points")));
  const ProgramResult refused = Fuse({"--mesh", "--out", OutFile("mesh.ply")});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, AllOf(IsOneLine(), HasSubstr("--out")));
}

TEST_F(FuseTest, ItsOptionsChangeTheCloudAndLeaveThatOfTheRunAlone) {
  const std::string cloud = ReadText(OutFile("cloud.ply"));
  const std::string other = folder_ / "other.ply";
  const size_t all = ReadSurfacePly(OutFile("cloud.ply")).size();
  for (const std::vector<std::string>& options : {std::vector<std::string>{"--voxel-size", "0.2"},
                                                  {"--max-range", "0.7"},
                                                  {"--min-support", "4"},
                                                  {"--max-error", "0.01"}}) {
    std::vector<std::string> arguments = options;
    arguments.insert(arguments.end(), {"--out", other, "--quiet"});
    const ProgramResult result = Fuse(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_LT(ReadSurfacePly(other).size(), all) << options[0];
  }
  EXPECT_EQ(ReadText(OutFile("cloud.ply")), cloud);
}

TEST_F(FuseTest, RefusesWhatIsMissingOrDamagedInOneLine) {
  const std::filesystem::path views = OutFile("views");
  const std::string description = ReadText(views / "views.json");
  const auto replaced = [&](const std::string& what, const std::string& by) {
    std::string text = description;
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  };
  WriteText(views / "views.json", description.substr(0, description.size() / 2));
  ExpectRefusal("views.json: is damaged");
  WriteText(views / "views.json", replaced("\"neighbours\": [", "\"neighbours\": [ 9999,"));
  ExpectRefusal("views.json: is damaged");
  WriteText(views / "views.json", replaced("\"frame\": ", "\"frame\": 99"));
  ExpectRefusal("views.json: is damaged");
  WriteText(views / "views.json", replaced("\"version\": 3", "\"version\": 7"));
  ExpectRefusal("another version");
  WriteText(views / "views.json", description);
  for (const auto& entry : std::filesystem::directory_iterator(views)) {
    if (entry.path().extension() != ".json") std::filesystem::resize_file(entry.path(), 99);
  }
  ExpectRefusal("is damaged or gone");
  std::filesystem::remove_all(views);
  ExpectRefusal("--save-views");
}

TEST_F(RunTest, ViewsAreOnlySavedOfADenseCloud) {
  WriteRoom();
  EXPECT_THAT(Refusal({"--save-views"}), HasSubstr("--save-views"));
}

}  // namespace
}  // namespace orb360
