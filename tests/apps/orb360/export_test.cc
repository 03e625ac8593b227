#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/io/ply.h"
#include "slam/io/sparse_model_file.h"
#include "tests/apps/orb360/run_fixture.h"
#include "tests/slam/io/synthetic_model.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The folder of a run as `orb360 run` leaves it, with a synthetic model and an input of plain
/// images, the brightness of which is the number of the frame.
class ExportTest : public testing::Test {
 protected:
  void WriteRun(const SparseModel& model) const {
    std::filesystem::create_directories(folder_ / "run");
    WriteSparseModel(folder_ / "run" / "reconstruction.h5", model);
    WriteText(folder_ / "run" / "summary.json",
              nlohmann::json{{"input", (folder_ / "input").string()}}.dump());
  }
  void WriteInput(const SparseModel& model, int count) const {
    std::vector<cv::Mat> images;
    for (int i = 0; i < count; ++i) {
      images.emplace_back(model.height, model.width, CV_8UC3, cv::Scalar::all(10 * i));
    }
    WriteFolder(folder_ / "input", images);
  }

  ProgramResult Export(const std::string& format, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"export", folder_ / "run", "--to",
                                          format,   "--out",         folder_ / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunOrb360(arguments);
  }
  /// Exit status 1, one line on standard error, which is returned, and nothing written.
  std::string Refusal(const std::string& format, const std::vector<std::string>& more = {}) const {
    const ProgramResult result = Export(format, more);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(IsOneLine(), testing::StartsWith("orb360: ")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    return result.err;
  }

  TempFolder folder_;
};

TEST_F(ExportTest, WhatIsNoFinishedRunIsRefusedInOneLine) {
  EXPECT_THAT(Refusal("colmap"), HasSubstr("run: is no folder"));
  std::filesystem::create_directories(folder_ / "run");
  EXPECT_THAT(Refusal("colmap"), HasSubstr("holds no finished run (there is no summary.json)"));
  WriteText(folder_ / "run" / "summary.json", "{\"input\": \"x\"}");
  EXPECT_THAT(Refusal("tum"), HasSubstr("has no reconstruction.h5, because an older orb360 made"));
  WriteRun(MakeSyntheticModel());
  const std::filesystem::path path = folder_ / "run" / "reconstruction.h5";
  CopyTruncated(path, path, 0.8);
  EXPECT_THAT(Refusal("tum"), HasSubstr("reconstruction.h5: is damaged"));
  WriteRun({64, 32, {}, {}});
  EXPECT_THAT(Refusal("tum"), HasSubstr("no frame of this run has a pose"));
  WriteRun(MakeSyntheticModel());
  WriteText(folder_ / "run" / "summary.json", "{");
  EXPECT_THAT(Refusal("tum"), HasSubstr("summary.json: is damaged"));
}

TEST_F(ExportTest, WhatTheFormatCannotDoIsRefusedInOneLine) {
  WriteRun(MakeSyntheticModel());
  EXPECT_THAT(Refusal("obj"),
              AllOf(HasSubstr("--to: there is no format `obj`"),
                    HasSubstr("tum, kitti, euroc, geojson, gpx, kml, colmap, colmap-rig")));
  EXPECT_THAT(Refusal("kitti", {"--points", "cloud"}), HasSubstr("--points: kitti is a format of"));
  EXPECT_THAT(Refusal("nerfstudio", {"--text"}), HasSubstr("--text: only COLMAP"));
  EXPECT_THAT(Refusal("opensfm", {"--views", "cube"}), HasSubstr("opensfm has panoramas only"));
  EXPECT_THAT(Refusal("colmap", {"--fov", "90"}), HasSubstr("--fov: a panorama has no field"));
  EXPECT_THAT(Refusal("colmap-rig", {"--fov", "80"}), HasSubstr("leave gaps"));
  EXPECT_THAT(Refusal("colmap", {"--views", "many"}), HasSubstr("neither sphere nor cube"));
  EXPECT_THAT(Refusal("images", {"--images", "none"}), HasSubstr("nothing to export"));
  EXPECT_THAT(Refusal("tum", {"--map", "3"}), HasSubstr("--map: the run has no map 3; it has 1"));
  EXPECT_THAT(Refusal("colmap", {"--images", "none", "--points", "cloud"}),
              HasSubstr("cloud.ply: cannot be opened"));
}

TEST_F(ExportTest, AnInputThatMovedIsAskedForAndFoundWithInput) {
  const SparseModel model = MakeSyntheticModel({6, 4, 64});
  WriteRun(model);
  EXPECT_THAT(Refusal("colmap"), AllOf(HasSubstr("the input of the run is not there any more"),
                                       HasSubstr("--input"), HasSubstr("--images none")));
  WriteInput(model, 6);
  std::filesystem::rename(folder_ / "input", folder_ / "elsewhere");
  const ProgramResult result = Export("colmap", {"--input", folder_ / "elsewhere"});
  EXPECT_EQ(result.status, 0) << result.err;
  const cv::Mat image = cv::imread(folder_ / "out" / "images" / "000004.jpg");
  ASSERT_EQ(image.size(), cv::Size(64, 32));
  EXPECT_NEAR(cv::mean(image)[0], 40, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "images" / "000002.jpg"))
      << "is no keyframe";
}

TEST_F(ExportTest, LensesAreStitchedByTheRunsCalibrationOrByAnother) {
  const SparseModel model = MakeSyntheticModel({2, 4, 64});
  WriteRun(model);
  cv::Mat lenses(64, 128, CV_8UC1);  // side by side: black and white
  lenses.colRange(0, 64) = 0;
  lenses.colRange(64, 128) = 255;
  const std::string video = folder_ / "lenses.avi";
  WriteVideo(video, {lenses, lenses});
  const auto columns = [&](const std::vector<std::string>& more) {
    std::filesystem::remove_all(folder_ / "out");
    std::vector<std::string> arguments = {"--images", "png", "--frames", "all", "--input", video};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Export("images", arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    const cv::Mat image = cv::imread(folder_ / "out" / "images" / "000001.png");
    EXPECT_EQ(image.size(), cv::Size(64, 32));
    return std::pair(cv::mean(image.col(32))[0], cv::mean(image.col(2))[0]);
  };
  // Without a calibration the video is taken for an equirectangular one, with a seam ahead.
  EXPECT_LT(columns({}).second, 10);
  // The first lens looks ahead and the second one back.
  const auto [ahead, behind] = columns({"--lens", "samsung-gear360"});
  EXPECT_LT(ahead, 40);
  EXPECT_GT(behind, 200);
  // The same calibration, as the run's summary has it.
  WriteText(folder_ / "run" / "summary.json",
            nlohmann::json{{"input", video}, {"lens", "samsung-gear360"}}.dump());
  EXPECT_EQ(columns({}), std::pair(ahead, behind));
}

TEST_F(ExportTest, AnInputWithFewerFramesThanTheRunTrackedIsNamed) {
  const SparseModel model = MakeSyntheticModel({6, 4, 64});
  WriteRun(model);
  WriteInput(model, 3);
  const ProgramResult result = Export("colmap");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("has no frame 3"), HasSubstr("--input")));
}

TEST_F(ExportTest, ImagesHaveTheSizeOfThoseThatWereTracked) {
  const SparseModel model = MakeSyntheticModel({2, 4, 64});
  WriteRun(model);
  WriteFolder(folder_ / "input", std::vector<cv::Mat>(2, cv::Mat(64, 128, CV_8UC3)));
  EXPECT_EQ(Export("images", {"--images", "png", "--frames", "all"}).status, 0);
  EXPECT_EQ(cv::imread(folder_ / "out" / "images" / "000001.png").size(), cv::Size(64, 32));
}

TEST_F(ExportTest, AFolderWithFilesIsNotMixedWithAnotherExport) {
  WriteRun(MakeSyntheticModel());
  std::filesystem::create_directories(folder_ / "out");
  EXPECT_EQ(Export("tum").status, 0);
  const ProgramResult result = Export("kitti");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("is not an empty folder")));
}

TEST_F(ExportTest, OfSeveralMapsTheLargestIsExportedOrTheOneAskedFor) {
  SparseModel model = MakeSyntheticModel({12, 4});
  for (size_t f = 0; f < 4; ++f) model.frames[f].map = 0;
  for (size_t f = 4; f < 12; ++f) model.frames[f].map = 1;
  WriteRun(model);
  const ProgramResult result = Export("tum");
  EXPECT_THAT(result.out, HasSubstr("of 2 maps the largest is exported, number 1"));
  EXPECT_EQ(ReadTrajectory(folder_ / "out" / "trajectory.txt").size(), 8u);
  std::filesystem::remove_all(folder_ / "out");
  EXPECT_EQ(Export("tum", {"--map", "0"}).status, 0);
  EXPECT_EQ(ReadTrajectory(folder_ / "out" / "trajectory.txt").size(), 4u);
}

TEST_F(ExportTest, PointsOfTheCloudReplaceTheLandmarks) {
  WriteRun(MakeSyntheticModel());
  std::vector<ColoredPoint> cloud;
  for (int i = 0; i < 3000; ++i) {
    cloud.push_back({Eigen::Vector3f(0.1f * (i % 60), 0.1f * (i / 60), 2), {1, 2, 3}});
  }
  WritePly(folder_ / "run" / "cloud.ply", cloud);
  ASSERT_EQ(
      Export("nerfstudio", {"--images", "none", "--points", "cloud", "--max-points", "800"}).status,
      0);
  const std::vector<ColoredPoint> points = ReadPly(folder_ / "out" / "sparse_pc.ply");
  EXPECT_LE(points.size(), 800u);
  EXPECT_GT(points.size(), 400u);
  for (const ColoredPoint& point : points) EXPECT_NEAR(point.position.z(), 2.0, 1e-6);
}

TEST_F(ExportTest, ACloudThatIsMissingOrDamagedIsRefusedAndNothingIsWritten) {
  WriteRun(MakeSyntheticModel());
  EXPECT_THAT(Refusal("las"), HasSubstr("run/cloud.ply: cannot be opened as a cloud"));
  WritePly(folder_ / "run" / "cloud.ply", std::vector<ColoredPoint>(5));
  CopyTruncated(folder_ / "run" / "cloud.ply", folder_ / "run" / "cloud.ply", 0.9);
  EXPECT_THAT(Refusal("las"), HasSubstr("run/cloud.ply: is not a cloud that orb360 wrote"));
  WritePly(folder_ / "run" / "cloud.ply", std::vector<ColoredPoint>(5));
  EXPECT_THAT(Refusal("las", {"--frames", "all"}), HasSubstr("--frames: las is a format of the"));
  EXPECT_THAT(Refusal("las", {"--map", "0"}), HasSubstr("--map: las is a format of the whole"));
  EXPECT_THAT(Refusal("las", {"--max-points", "9"}), HasSubstr("--max-points: las is a format"));
  WriteText(folder_ / "run" / "georeference.json", "{\"version\": 1}");
  EXPECT_THAT(Refusal("las"), HasSubstr("georeference.json: is damaged"));
  EXPECT_THAT(Refusal("mcap", {"--images", "none"}), HasSubstr("georeference.json: is damaged"));
}

TEST_F(ExportTest, LasOfARunOfUnknownScaleSaysSo) {
  WriteRun(MakeSyntheticModel());
  WritePly(folder_ / "run" / "cloud.ply", std::vector<ColoredPoint>(5));
  EXPECT_THAT(Export("las").out,
              AllOf(HasSubstr("`orb360 georeference` places a run on Earth"),
                    HasSubstr("wrote 5 points"), testing::Not(HasSubstr("scale"))));
  WriteText(folder_ / "run" / "summary.json",
            R"({"input": "none", "scale": {"state": "unknown"}})");
  std::filesystem::remove_all(folder_ / "out");
  EXPECT_THAT(Export("las").out, HasSubstr("the scale of this run is unknown"));
}

TEST_F(ExportTest, WhatRosCannotHoldIsRefused) {
  SparseModel model = MakeSyntheticModel({6, 4, 64});
  WriteRun(model);
  EXPECT_THAT(Refusal("mcap", {"--views", "cube"}), HasSubstr("mcap has panoramas only"));
  EXPECT_THAT(Refusal("mcap"), HasSubstr("the input of the run is not there any more"));
  model.frames[0].timestamp = -0.5;
  WriteRun(model);
  EXPECT_THAT(Refusal("mcap", {"--images", "none"}), HasSubstr("the time of frame 0 is -0.5 s"));
  model.frames[0].timestamp = 0;
  WriteRun(model);
  WriteInput(model, 3);
  const ProgramResult result = Export("mcap");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(IsOneLine(), HasSubstr("has no frame 3")));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "out")) << "half a file is none";
}

/// A room through which the camera moves steadily; some exposures are so long that the image is
/// the mean of what is seen on the way.
TEST_F(ExportTest, ImagesForSplattingAreSharperThanUniformOnesAndLeaveNoGap) {
  const TexturedRoom room(kSize);
  constexpr int kCount = 60;
  std::vector<cv::Mat> images;
  SparseModel model{kSize.width, kSize.height, {}, {}};
  const std::vector<StampedPose> poses = TexturedRoom::Trajectory(kCount, 30);
  const std::vector<cv::Mat> sharp = room.DrawAll(kCount);
  for (int i = 0; i < kCount; ++i) {
    cv::Mat image = sharp[static_cast<size_t>(i)].clone();
    const int exposure = i % 3 == 0 ? 0 : 1 + i % 2;  // frames before and after
    cv::Mat sum = cv::Mat::zeros(kSize, CV_32FC1);
    int count = 0;
    for (int k = std::max(0, i - exposure); k <= std::min(kCount - 1, i + exposure); ++k) {
      cv::accumulate(sharp[static_cast<size_t>(k)], sum);
      ++count;
    }
    sum.convertTo(image, CV_8U, 1.0 / count);
    images.push_back(image);
    PosedFrame frame;
    frame.index = i;
    frame.timestamp = poses[static_cast<size_t>(i)].timestamp;
    frame.is_keyframe = i == 0;
    frame.world_from_optical.translation =
        poses[static_cast<size_t>(i)].world_from_camera.translation;
    model.frames.push_back(frame);
  }
  // At 2 m, with a spacing of a tenth: 20 cm, or five frames, between two images.
  model.points.push_back(
      {model.frames[0].world_from_optical.translation + Eigen::Vector3d(0, 2, 0), {}});
  model.frames[0].observations.push_back({{10, 10}, 0});
  WriteRun(model);
  WriteFolder(folder_ / "input", images);
  const ProgramResult result = Export("images", {"--images", "png"});
  ASSERT_EQ(result.status, 0) << result.err;

  // Sharpness by another measure than the exporter's: the mean difference of neighbours.
  const auto sharpness = [](const cv::Mat& gray) {
    cv::Mat right;
    cv::absdiff(gray.colRange(1, gray.cols), gray.colRange(0, gray.cols - 1), right);
    return cv::mean(right)[0];
  };
  const auto median = [](std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
  };
  std::vector<double> selected;
  std::vector<int> frames;
  for (int i = 0; i < kCount; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "%06d.png", i);
    const std::filesystem::path path = folder_ / "out" / "images" / name;
    if (!std::filesystem::exists(path)) continue;
    frames.push_back(i);
    selected.push_back(sharpness(cv::imread(path, cv::IMREAD_GRAYSCALE)));
  }
  ASSERT_GE(frames.size(), 7u);
  ASSERT_LE(frames.size(), 24u);
  std::vector<double> uniform;
  for (size_t i = 0; i < frames.size(); ++i) {
    uniform.push_back(sharpness(images[i * images.size() / frames.size()]));
  }
  EXPECT_GT(median(selected), 1.1 * median(uniform));
  const auto place = [&](int i) { return model.frames[static_cast<size_t>(i)].world_from_optical; };
  for (size_t i = 1; i < frames.size(); ++i) {
    const double step = (place(frames[i]).translation - place(frames[i - 1]).translation).norm();
    EXPECT_GE(step, 0.099);
    EXPECT_LE(step, 0.301);
  }
  EXPECT_EQ(ReadTrajectory(folder_ / "out" / "trajectory.txt").size(), frames.size());
}

}  // namespace
}  // namespace orb360
