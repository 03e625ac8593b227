#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/io/ply.h"
#include "slam/io/sparse_file.h"
#include "slam/io/sparse_model_file.h"
#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/run_fixture.h"
#include "tests/apps/orb360/textured_room.h"
#include <orb360/slam/io/map_file.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(RunTest, AFolderOfGreyImagesIsTrackedAndEverythingIsWritten) {
  WriteRoom();
  const ProgramResult result = Run();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("24 of 24 frames tracked in 1 map"));
  const std::vector<StampedPose> poses = ReadTrajectory(OutFile("trajectory.txt"));
  ASSERT_EQ(poses.size(), static_cast<size_t>(kFrames));
  EXPECT_NEAR(poses[3].timestamp, 3 / 30.0, 1e-9);
  // The first camera is the world: x forward, y left, z up.
  EXPECT_LT(poses[0].world_from_camera.translation.norm(), 1e-8);
  EXPECT_GT(poses[9].world_from_camera.translation.normalized().x(), 0.8);
  EXPECT_GE(PosesIn("keyframes.txt"), 2u);
  EXPECT_FALSE(std::filesystem::exists(OutFile("trajectory.journal")));

  const nlohmann::json summary = Summary();
  EXPECT_EQ(summary["frames"], kFrames);
  EXPECT_EQ(summary["tracked"], kFrames);
  EXPECT_EQ(summary["maps"], 1);
  EXPECT_TRUE(summary["map_changes"].empty());
  EXPECT_EQ(summary["lost"], 0);
  EXPECT_EQ(summary["threads"], 1);
  EXPECT_EQ(summary["weights"], "none");
  EXPECT_EQ(summary["interrupted"], false);
  EXPECT_EQ(summary["landmarks"], ReadPly(OutFile("cloud.ply")).size());
  EXPECT_GT(summary["landmarks"], 100);
  EXPECT_GE(summary["initialized_at"], 1);
  EXPECT_GT(summary["timing_ms"]["frame"]["median"], 0.0);
  EXPECT_GE(summary["timing_ms"]["frame"]["p95"], summary["timing_ms"]["frame"]["median"]);
  for (const char* key : {"keyframes", "scale", "version"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  EXPECT_GT(summary["seconds"], summary["finishing_seconds"]);
  EXPECT_GT(summary["landmarks_per_keyframe"], 50.0);
  EXPECT_GE(summary["features_per_keyframe"], summary["landmarks_per_keyframe"]);
}

TEST_F(RunTest, TheSameInputGivesTheSameBytesWithOneAndTwoThreads) {
  WriteRoom();
  EXPECT_EQ(Run().status, 0);
  EXPECT_EQ(
      RunOrb360({"run", Input(), "--out", folder_ / "two", "--threads", "2", "--weights", "none"})
          .status,
      0);
  for (const char* name :
       {"trajectory.txt", "keyframes.txt", "cloud.ply", "map.svg", "reconstruction.h5"}) {
    EXPECT_EQ(ReadText(OutFile(name)), ReadText(folder_ / "two" / name)) << name;
  }
}

TEST_F(RunTest, TheNetworkThatComesWithItIsUsedUnlessNoneIsWanted) {
  WriteRoom();
  const ProgramResult result = RunOrb360({"run", Input(), "--out", Out(), "--threads", "1"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(Summary()["weights"].get<std::string>(), EndsWith("depth_completion.h5"));
  EXPECT_TRUE(std::filesystem::exists(OutFile("landmarks.ply")));
}

TEST_F(RunTest, AMapMayLieInTheFolderOfTheResults) {
  WriteRoom();
  const ProgramResult result = Run({"--map-out", OutFile("room.map")});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_GT(ReadMap(OutFile("room.map")).map.num_keyframes(), 1);
}

TEST_F(RunTest, TheReportIsOnePageOfEverything) {
  WriteRoom();
  EXPECT_EQ(Run().status, 0);
  const std::string html = ReadText(OutFile("report.html"));
  EXPECT_THAT(html, AllOf(HasSubstr(Input()), HasSubstr("\"tracked\":24"),
                          HasSubstr("id=\"embedded-octree\""), Not(HasSubstr("src=\"viewer"))));
}

TEST_F(RunTest, SixteenBitImagesGiveTheTrajectoryOfEightBitOnes) {
  std::vector<cv::Mat> images = TexturedRoom(kSize).DrawAll(kFrames);
  WriteFolder(Input(), images);
  EXPECT_EQ(Run().status, 0);
  for (cv::Mat& image : images) image.convertTo(image, CV_16U, 257.0);
  WriteFolder(folder_ / "deep", images);
  EXPECT_EQ(RunOrb360({"run", folder_ / "deep", "--out", folder_ / "deep_out", "--threads", "1",
                       "--weights", "none"})
                .status,
            0);
  EXPECT_EQ(ReadText(OutFile("trajectory.txt")), ReadText(folder_ / "deep_out" / "trajectory.txt"));
}

TEST_F(RunTest, ATruncatedVideoIsTrackedToWhereItEnds) {
  WriteVideo(folder_ / "whole.avi", TexturedRoom(kSize).DrawAll(kFrames));
  CopyTruncated(folder_ / "whole.avi", Input(), 0.6);
  const ProgramResult result = Run();
  EXPECT_EQ(result.status, 0) << result.err;
  const int frames = Summary()["frames"];
  EXPECT_GT(frames, 10);
  EXPECT_LT(frames, 20);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr(Input()),
                                HasSubstr("ends at frame " + std::to_string(frames) + " of 24")));
  EXPECT_EQ(PosesIn("trajectory.txt"), static_cast<size_t>(frames));
  EXPECT_EQ(Summary()["warnings"].size(), 1u);
}

TEST_F(RunTest, AZeroByteFrameCostsThatFrameOnly) {
  WriteRoom();
  WriteText(folder_ / "input" / "000012.png", "");
  const ProgramResult result = Run();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("000012.png"), HasSubstr("0 bytes")));
  const std::vector<StampedPose> poses = ReadTrajectory(OutFile("trajectory.txt"));
  ASSERT_EQ(poses.size(), static_cast<size_t>(kFrames - 1));
  EXPECT_NEAR(poses[11].timestamp, 11 / 30.0, 1e-9);
  EXPECT_NEAR(poses[12].timestamp, 13 / 30.0, 1e-9);
}

TEST_F(RunTest, AnotherSizeThatShowsOnlyInTheMiddleKeepsWhatWasDone) {
  std::vector<cv::Mat> images = TexturedRoom(kSize).DrawAll(kFrames);
  cv::resize(images[20], images[20], kSize / 2);
  WriteFolder(Input(), images, ".bmp");
  const ProgramResult result = Run();
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("000020.bmp"), HasSubstr("192x96")));
  EXPECT_EQ(PosesIn("trajectory.txt"), 20u);
  EXPECT_EQ(Summary()["interrupted"], true);
}

TEST_F(RunTest, AFolderThatCannotBeWrittenIsRefusedBeforeAnyWork) {
  WriteBlanks();
  WriteText(folder_ / "file", "");
  for (const std::string& out : {std::string(folder_ / "file" / "out"), std::string("/proc/out")}) {
    const ProgramResult result = RunOrb360({"run", Input(), "--out", out});
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr(out), HasSubstr("cannot be written")));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

TEST_F(RunTest, ANumberThatIsNoneIsRefused) {
  for (const char* option : {"--camera-height", "--fps"}) {
    const ProgramResult run = Run({option, "nan"});
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.err, AllOf(IsOneLine(), HasSubstr(std::string(option) + ": Value nan")));
  }
}

TEST_F(RunTest, AConfigurationIsUsed) {
  WriteRoom();
  EXPECT_EQ(Run().status, 0);
  const double before = Summary()["features_per_keyframe"];
  WriteText(folder_ / "c.yaml", "features:\n  count: 500\n");
  EXPECT_EQ(Run({"--config", folder_ / "c.yaml"}).status, 0);
  EXPECT_LT(Summary()["features_per_keyframe"], 0.7 * before);
}

TEST_F(RunTest, SelectionOfFramesKeepsTheSourcesTimes) {
  WriteRoom();
  EXPECT_EQ(Run({"--fps", "10", "--start", "3", "--stride", "2", "--max-frames", "9"}).status, 0);
  const std::vector<StampedPose> poses = ReadTrajectory(OutFile("trajectory.txt"));
  ASSERT_EQ(poses.size(), 9u);
  EXPECT_NEAR(poses[0].timestamp, 0.3, 1e-9);
  EXPECT_NEAR(poses[8].timestamp, 1.9, 1e-9);
}

TEST_F(RunTest, AMaskKeepsLandmarksOutOfWhatItCovers) {
  WriteRoom();
  cv::Mat mask(kSize, CV_8UC1, cv::Scalar(255));
  mask.rowRange(kSize.height / 2, kSize.height).setTo(0);
  WriteFolder(folder_ / "mask", {mask});
  EXPECT_EQ(Run({"--mask", folder_ / "mask" / "000000.png"}).status, 0);
  size_t below = 0;
  const std::vector<ColoredPoint> cloud = ReadPly(OutFile("cloud.ply"));
  for (const ColoredPoint& point : cloud) {
    // The camera moves little up and down; its horizon is the mask's edge.
    const double elevation = point.position.z() / point.position.head<2>().norm();
    if (elevation < -0.15) ++below;
  }
  EXPECT_GT(cloud.size(), 100u);
  EXPECT_LT(below, cloud.size() / 50);
  // Exporters find the mask in the folder, until a run there has none.
  EXPECT_EQ(cv::norm(cv::imread(OutFile("mask.png"), cv::IMREAD_UNCHANGED), mask, cv::NORM_INF),
            0.0);
  EXPECT_EQ(Run({"--mask", "none"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(OutFile("mask.png")));
}

TEST_F(RunTest, TheReconstructionHasTheFramesOfTheTrajectoryAndTheLandmarksOfTheCloud) {
  WriteRoom();
  EXPECT_EQ(Run().status, 0);
  const SparseModel model = ReadSparseModel(OutFile("reconstruction.h5"));
  EXPECT_EQ(model.width, kSize.width);
  EXPECT_EQ(model.height, kSize.height);
  const std::vector<StampedPose> poses = ReadTrajectory(OutFile("trajectory.txt"));
  ASSERT_EQ(model.frames.size(), poses.size());
  Eigen::Matrix3d camera_from_optical;
  camera_from_optical << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    const PosedFrame& frame = model.frames[i];
    EXPECT_EQ(frame.index, static_cast<int>(i));
    EXPECT_NEAR(frame.timestamp, poses[i].timestamp, 1e-9);
    EXPECT_LT(
        (frame.world_from_optical.translation - poses[i].world_from_camera.translation).norm(),
        1e-8);
    const Eigen::Quaterniond rotation =
        poses[i].world_from_camera.rotation * Eigen::Quaterniond(camera_from_optical);
    EXPECT_LT(frame.world_from_optical.rotation.angularDistance(rotation), 1e-7);
  }
  const auto is_keyframe = [](const PosedFrame& frame) { return frame.is_keyframe; };
  EXPECT_EQ(std::ranges::count_if(model.frames, is_keyframe), Summary()["keyframes"]);
  const std::vector<ColoredPoint> cloud = ReadPly(OutFile("cloud.ply"));
  ASSERT_EQ(model.points.size(), cloud.size());
  for (size_t p = 0; p < cloud.size(); ++p) {
    EXPECT_LT((model.points[p].position.cast<float>() - cloud[p].position).norm(), 1e-5);
  }
}

TEST_F(RunTest, ByDefaultWhatMovesWithTheCameraIsMasked) {
  std::vector<cv::Mat> images = TexturedRoom(kSize).DrawAll(kFrames);
  for (cv::Mat& image : images) images[0].rowRange(144, 192).copyTo(image.rowRange(144, 192));
  WriteFolder(Input(), images);
  // Five frames a second: the clip is long enough to tell.
  EXPECT_EQ(Run({"--fps", "5"}).status, 0);
  // Below 45 degrees lie (1 - sin(45 deg)) / 2 = 14.6 % of the sphere.
  EXPECT_NEAR(Summary()["masked_fraction"], 0.146, 0.04);
  EXPECT_EQ(Run({"--fps", "5", "--mask", "none"}).status, 0);
  EXPECT_EQ(Summary()["masked_fraction"], 0.0);
}

TEST_F(RunTest, WhereSparseDepthCannotBeWrittenTheCloudIs) {
  WriteRoom();
  WriteMeanNetwork(folder_ / "net.h5");
  std::filesystem::create_directories(OutFile(""));
  std::ofstream(OutFile("sparse")) << "no folder";
  const ProgramResult result = Run({"--weights", folder_ / "net.h5", "--save-sparse"});
  EXPECT_NE(result.status, 0);
  EXPECT_NE(result.err.find("sparse"), std::string::npos) << result.err;
  EXPECT_GT(ReadSurfacePly(OutFile("cloud.ply")).size(), 100u);
}

TEST_F(RunTest, SaveSparseWritesEveryKeyframeWithItsImage) {
  WriteRoom();
  EXPECT_EQ(Run({"--save-sparse", "--start", "2"}).status, 0);
  const std::vector<StampedPose> keyframes = ReadTrajectory(OutFile("keyframes.txt"));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(OutFile("sparse"))) {
    const SparseSample sample = ReadSparseSample(entry.path());
    const cv::Mat image = cv::imread(Image(sample.frame_index), cv::IMREAD_COLOR);
    EXPECT_EQ(cv::norm(sample.image, image, cv::NORM_INF), 0.0);
    EXPECT_GT(cv::countNonZero(sample.sparse.range), 50);
    EXPECT_TRUE(std::ranges::any_of(keyframes, [&](const StampedPose& pose) {
      return std::abs(pose.timestamp - sample.timestamp) < 1e-6;
    }));
    ++files;
  }
  EXPECT_EQ(files, Summary()["keyframes"]);
}

TEST_F(RunTest, AMapIsKeptAndTheNextRunIsLocatedInItsWorld) {
  WriteRoom();
  const std::string map = folder_ / "room.map";
  ASSERT_EQ(Run({"--map-out", map}).status, 0);
  const std::vector<StampedPose> made = ReadTrajectory(OutFile("trajectory.txt"));
  const nlohmann::json first = Summary();
  const ProgramResult result = Run({"--map-in", map, "--localize"});
  EXPECT_EQ(result.status, 0) << result.err;
  const std::vector<StampedPose> located = ReadTrajectory(OutFile("trajectory.txt"));
  ASSERT_EQ(made.size(), static_cast<size_t>(kFrames));
  ASSERT_EQ(located.size(), made.size());
  const auto place = [](const StampedPose& pose) { return pose.world_from_camera.translation; };
  const double length = (place(made.back()) - place(made.front())).norm();
  for (size_t i = 0; i < made.size(); ++i) {
    EXPECT_LT((place(located[i]) - place(made[i])).norm(), 0.02 * length) << i;
  }
  EXPECT_EQ(Summary()["maps"], 1);
  EXPECT_EQ(Summary()["relocalizations"], 1);
  EXPECT_EQ(Summary()["keyframes"], first["keyframes"]);
  // Going on in it adds to it instead.
  ASSERT_EQ(Run({"--map-in", map, "--map-out", map}).status, 0);
  EXPECT_EQ(Summary()["maps"], 1);
  EXPECT_GE(ReadMap(map).map.num_keyframes(), first["keyframes"]);
}

TEST_F(RunTest, TheSummaryTellsWhenAnotherMapBegins) {
  // The room, and from frame 24 on a mirrored one, in which nothing looks as before. Its map is
  // begun later and then tracked backwards, so that no frame is missing in between.
  std::vector<cv::Mat> images = TexturedRoom(kSize).DrawAll(kFrames + 36);
  for (size_t i = kFrames; i < images.size(); ++i) cv::flip(images[i].clone(), images[i], 1);
  WriteFolder(Input(), images);
  EXPECT_EQ(Run().status, 0);
  const nlohmann::json summary = Summary();
  ASSERT_EQ(summary["maps"], 2);
  ASSERT_EQ(summary["map_changes"].size(), 1u);
  EXPECT_NEAR(summary["map_changes"][0], kFrames / 30.0, 1e-9);
  EXPECT_EQ(PosesIn("trajectory.txt"), images.size());
}

TEST_F(RunTest, ACameraThatStandsStillEndsWithTheReason) {
  WriteFolder(Input(), std::vector<cv::Mat>(6, TexturedRoom(kSize).Draw(0)));
  const ProgramResult result = Run();
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("no pose was found in its 6 frames")));
  EXPECT_EQ(Summary()["tracked"], 0);
  EXPECT_EQ(Summary()["initialized_at"], nullptr);
}

TEST_F(RunTest, QuietShowsNothing) {
  WriteRoom();
  const ProgramResult result = Run({"--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, IsEmpty());
}

}  // namespace
}  // namespace orb360
