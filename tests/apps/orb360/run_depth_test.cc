#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "slam/io/ply.h"
#include "slam/io/sparse_file.h"
#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/run_fixture.h"
#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

using ::testing::HasSubstr;

TEST_F(RunTest, WithANetworkTheCloudIsDenseAndTheSameForAnyNumberOfThreads) {
  WriteRoom();
  WriteMeanNetwork(folder_ / "net.h5");
  // A point must be seen by three keyframes; the room is small and the way short.
  WriteText(folder_ / "dense.yaml", "keyframe:\n  max_motion: 0.02\n");
  const std::vector<std::string> dense = {"--weights", folder_ / "net.h5", "--config",
                                          folder_ / "dense.yaml"};
  std::vector<std::string> options = dense;
  options.insert(options.end(), {"--save-depth", "--save-sparse"});
  const ProgramResult result = Run(options);
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<SurfacePoint> points = ReadSurfacePly(OutFile("cloud.ply"));
  EXPECT_GT(points.size(), 1000u);
  const nlohmann::json summary = Summary();
  EXPECT_EQ(summary["cloud"]["points"], points.size());
  EXPECT_EQ(summary["landmarks"], ReadPly(OutFile("landmarks.ply")).size());
  const auto files = [](const std::filesystem::path& folder) {
    return std::distance(std::filesystem::directory_iterator(folder), {});
  };
  EXPECT_EQ(files(OutFile("depth")), summary["cloud"]["views"].get<int>());
  EXPECT_EQ(files(OutFile("confidence")), summary["cloud"]["views"].get<int>());
  EXPECT_EQ(files(OutFile("source")), summary["cloud"]["views"].get<int>());
  int num_measured = 0;
  for (const auto& entry : std::filesystem::directory_iterator(OutFile("source"))) {
    const cv::Mat source = ReadSourceImage(entry.path());
    num_measured += cv::countNonZero(source == static_cast<double>(RangeSource::kMeasured));
  }
  EXPECT_GT(num_measured, 0);
  EXPECT_EQ(files(OutFile("sparse")), summary["cloud"]["views"].get<int>());
  for (const auto& entry : std::filesystem::directory_iterator(OutFile("sparse"))) {
    const SparseSample sample = ReadSparseSample(entry.path());
    EXPECT_GT(cv::countNonZero(sample.sparse.range), 50) << entry.path();
    EXPECT_NEAR(sample.timestamp, sample.frame_index / 30.0, 1e-3) << entry.path();
  }
  EXPECT_THAT(ReadText(OutFile("report.html")), HasSubstr("id=\"embedded-octree\""));
  EXPECT_FALSE(std::filesystem::exists(OutFile("depth.tmp")));
  EXPECT_FALSE(std::filesystem::exists(OutFile("cloud.ply.voxels")));

  options = {"run", Input(), "--out", folder_ / "two", "--threads", "2"};
  options.insert(options.end(), dense.begin(), dense.end());
  EXPECT_EQ(RunOrb360(options).status, 0);
  EXPECT_EQ(ReadText(OutFile("cloud.ply")), ReadText(folder_ / "two" / "cloud.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "two" / "depth"));
}

TEST_F(RunTest, DepthOfAnEarlierRunInTheFolderDoesNotStay) {
  WriteRoom();
  WriteMeanNetwork(folder_ / "net.h5");
  const std::filesystem::path old = OutFile("depth") / "999999.png";
  const std::filesystem::path others = OutFile("depth") / "mine.png";
  const auto write_old = [&] {
    std::filesystem::create_directories(OutFile("depth"));
    WriteText(old, "of an earlier run");
  };
  // Without the summary of a run it is not known whose they are.
  write_old();
  ASSERT_EQ(Run().status, 0);
  EXPECT_TRUE(std::filesystem::exists(old));

  WriteText(others, "not of a run");
  ASSERT_EQ(Run({"--weights", folder_ / "net.h5", "--save-depth"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(others));
  EXPECT_TRUE(std::filesystem::exists(OutFile("confidence")));
  EXPECT_TRUE(std::filesystem::exists(OutFile("source")));

  write_old();
  std::filesystem::remove(others);
  ASSERT_EQ(Run({"--weights", folder_ / "net.h5"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(OutFile("depth")));
  EXPECT_FALSE(std::filesystem::exists(OutFile("confidence")));
  EXPECT_FALSE(std::filesystem::exists(OutFile("source")));

  write_old();
  ASSERT_EQ(Run().status, 0);
  EXPECT_FALSE(std::filesystem::exists(OutFile("depth")));
}

}  // namespace
}  // namespace orb360
