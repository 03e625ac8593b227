#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "slam/io/ply.h"
#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/textured_room.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/io/depth_image.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kFrames = 60;

/// Ground truth, and an estimate of its first 45 poses at half the size.
class EvaluateTest : public testing::Test {
 protected:
  EvaluateTest() {
    std::vector<StampedPose> poses = TexturedRoom::Trajectory(kFrames, 20.0);
    WriteTrajectory(Truth(), poses);
    const Similarity3 half{0.5, Eigen::Quaterniond::Identity(), {3, 2, 1}};
    for (StampedPose& pose : poses) {
      pose.world_from_camera = TransformPose(half, pose.world_from_camera);
    }
    poses.resize(45);
    WriteTrajectory(Estimate(), poses);
  }

  std::string Truth() const { return folder_ / "groundtruth.txt"; }
  std::string Estimate() const { return folder_ / "trajectory.txt"; }

  static nlohmann::json Report(const std::string& truth, const std::string& estimate) {
    const ProgramResult result = RunOrb360({"evaluate", truth, estimate, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  TempFolder folder_;
};

TEST_F(EvaluateTest, JsonHasTheErrorsOfAScaledTrajectory) {
  const nlohmann::json report = Report(Truth(), Estimate());
  EXPECT_EQ(report["pairs"], 45);
  EXPECT_NEAR(report["tracked_fraction"], 0.75, 1e-9);
  EXPECT_NEAR(report["scale_factor"], 2.0, 1e-6);
  EXPECT_NEAR(report["ate_rmse_sim3"], 0.0, 1e-6);
  EXPECT_GT(report["ate_rmse_se3"], 0.1);
  EXPECT_NEAR(report["rpe_trans_percent"], 0.0, 1e-3);
  EXPECT_NEAR(report["rpe_raw_percent"], 50.0, 1.0);
  EXPECT_NEAR(report["rpe_rot_deg_per_m"], 0.0, 1e-3);
}

TEST_F(EvaluateTest, FoldersStandForTheFilesInThem) {
  WriteText(folder_ / "summary.json",
            R"({"frames": 50, "tracked": 45, "features_per_keyframe": 321.5,
                "landmarks_per_keyframe": 210.5})");
  const nlohmann::json report = Report(folder_.path(), folder_.path());
  EXPECT_EQ(report["pairs"], 45);
  EXPECT_NEAR(report["tracked_fraction"], 0.9, 1e-9);
  EXPECT_EQ(report["features_per_keyframe"], 321.5);
  EXPECT_EQ(report["landmarks_per_keyframe"], 210.5);
}

TEST_F(EvaluateTest, LoopsOfTheRunAreComparedWithThoseOfTheTruth) {
  // Once round a square of 20 m and 5 m farther, a metre each second.
  std::vector<StampedPose> poses;
  const std::vector<Eigen::Vector3d> sides = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  Eigen::Vector3d position(0, 0, 0);
  for (int i = 0; i < 85; ++i, position += sides[i / 20 % 4]) {
    poses.push_back({static_cast<double>(i), {Eigen::Quaterniond::Identity(), position}});
  }
  WriteTrajectory(Truth(), poses);
  WriteTrajectory(Estimate(), poses);
  WriteText(folder_ / "summary.json",
            R"({"frames": 85, "tracked": 85, "loop_times": [[82, 2], [70, 20]]})");
  const nlohmann::json loops = Report(folder_.path(), folder_.path())["loops"];
  EXPECT_EQ(loops, (nlohmann::json{{"revisits", 1}, {"closed", 1}, {"wrong", 1}}));
  EXPECT_THAT(RunOrb360({"evaluate", folder_.path(), folder_.path()}).out,
              HasSubstr("wrong loops"));
}

TEST_F(EvaluateTest, TheLocalScaleIsThatOfEachPartOfThePath) {
  // 300 m, a metre each second. From 150 m on the estimate is twice too small.
  std::vector<StampedPose> truth;
  std::vector<StampedPose> estimate;
  for (int i = 0; i <= 300; ++i) {
    const double x = i <= 150 ? i : 150 + 0.5 * (i - 150);
    truth.push_back({1.0 * i, {Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0}}});
    estimate.push_back({1.0 * i, {Eigen::Quaterniond::Identity(), {0, x, 0}}});
  }
  WriteTrajectory(Truth(), truth);
  WriteTrajectory(Estimate(), estimate);
  const nlohmann::json scale = Report(folder_.path(), folder_.path())["local_scale"];
  EXPECT_EQ(scale["window_m"], 20.0);
  EXPECT_EQ(scale["windows"], 57);
  EXPECT_NEAR(scale["min"], 1.0, 1e-6);
  EXPECT_NEAR(scale["max"], 2.0, 1e-6);
  EXPECT_NEAR(scale["drift_worst_per_100m"], std::log(2.0), 1e-6);
  EXPECT_NEAR(scale["worst_deviation_100m"], 1.0, 1e-6);
  EXPECT_THAT(RunOrb360({"evaluate", Truth(), Estimate()}).out,
              AllOf(HasSubstr("local scale"), HasSubstr("2.00000"), HasSubstr("69.31")));
  // The path continues in another map there, so that the windows across are left out.
  WriteText(folder_ / "summary.json", R"({"frames": 301, "tracked": 301, "map_changes": [151.0]})");
  EXPECT_EQ(Report(folder_.path(), folder_.path())["local_scale"]["windows"], 57 - 4);
}

TEST_F(EvaluateTest, AShortPathHasNoLocalScale) {
  const nlohmann::json report = Report(Truth(), Estimate());  // 2.4 m
  ASSERT_TRUE(report.contains("local_scale"));
  EXPECT_TRUE(report["local_scale"].is_null());
  EXPECT_THAT(RunOrb360({"evaluate", Truth(), Estimate()}).out, Not(HasSubstr("local scale")));
  std::vector<StampedPose> poses;  // 60 m
  for (int i = 0; i <= 60; ++i) {
    poses.push_back({1.0 * i, {Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0}}});
  }
  WriteTrajectory(Truth(), poses);
  const nlohmann::json scale = Report(Truth(), Truth())["local_scale"];
  EXPECT_EQ(scale["windows"], 9);
  EXPECT_TRUE(scale["drift_median_per_100m"].is_null());
  EXPECT_TRUE(scale["worst_deviation_100m"].is_null());
  EXPECT_THAT(RunOrb360({"evaluate", Truth(), Truth()}).out,
              AllOf(HasSubstr("local scale"), Not(HasSubstr("drift in 100 m"))));
}

TEST_F(EvaluateTest, DepthIsComparedWhereBothFoldersHaveIt) {
  const std::filesystem::path run = folder_ / "run";
  std::filesystem::create_directories(run / "depth");
  std::filesystem::create_directory(folder_ / "depth");
  std::filesystem::copy(Estimate(), run / "trajectory.txt");
  EXPECT_FALSE(Report(folder_.path(), run).contains("depth"));
  WriteDepthImage(folder_ / "depth" / "000000.png", cv::Mat(16, 32, CV_32FC1, cv::Scalar(15.0f)));
  WriteDepthImage(run / "depth" / "000000.png", cv::Mat(16, 32, CV_32FC1, cv::Scalar(18.0f)));
  const nlohmann::json depth = Report(folder_.path(), run)["depth"];
  EXPECT_EQ(depth["images"], 1);
  EXPECT_NEAR(depth["all"]["rmse"], 3.0, 1e-6);
  EXPECT_NEAR(depth["all"]["abs_rel"], 0.2, 1e-6);
  EXPECT_EQ(depth["by_image"][0]["name"], "000000.png");
  EXPECT_NEAR(depth["by_image"][0]["abs_rel"], 0.2, 1e-6);
  EXPECT_NEAR(depth["by_range_m"][2]["mae"], 3.0, 1e-6);
  EXPECT_TRUE(depth["by_range_m"][0]["mae"].is_null());
  EXPECT_THAT(RunOrb360({"evaluate", folder_.path(), run}).out,
              AllOf(HasSubstr("depth, 1 images"), HasSubstr("10 to 20 m"), HasSubstr("000000.png"),
                    Not(HasSubstr("most confident"))));

  EXPECT_FALSE(depth.contains("calibration"));
  std::filesystem::create_directory(run / "confidence");
  WriteFractionImage(run / "confidence" / "000000.png",
                     cv::Mat(16, 32, CV_32FC1, cv::Scalar(0.8F)));
  const nlohmann::json stated = Report(folder_.path(), run)["depth"]["calibration"];
  ASSERT_EQ(stated["tenths"].size(), 10U);
  EXPECT_NEAR(stated["tenths"][3]["stated"], 0.25, 1e-4);
  EXPECT_NEAR(stated["tenths"][3]["observed"], 0.2, 1e-4);
  EXPECT_EQ(stated["risk"][0]["coverage"], 0.5);
  EXPECT_NEAR(stated["risk"][0]["abs_rel"], 0.2, 1e-4);
  EXPECT_THAT(RunOrb360({"evaluate", folder_.path(), run}).out,
              AllOf(HasSubstr("most confident"), HasSubstr("25.0"), HasSubstr("20.0"),
                    Not(HasSubstr("measured"))));

  std::filesystem::create_directory(run / "source");
  WriteSourceImage(run / "source" / "000000.png", cv::Mat(16, 32, CV_8UC1, cv::Scalar(1)));
  const nlohmann::json known = Report(folder_.path(), run)["depth"]["calibration"]["sources"];
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0]["source"], "measured");
  EXPECT_EQ(known[0]["fraction"], 1.0);
  EXPECT_NEAR(known[0]["stated"], 0.25, 1e-4);
  EXPECT_NEAR(known[0]["observed"], 0.2, 1e-4);
  EXPECT_THAT(RunOrb360({"evaluate", folder_.path(), run}).out, HasSubstr("measured"));
}

TEST_F(EvaluateTest, WithoutJsonATableIsPrinted) {
  const ProgramResult result = RunOrb360({"evaluate", Truth(), Estimate()});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("scale factor (1 is perfect)"), HasSubstr("2.00000")));
}

TEST_F(EvaluateTest, ThePlotIsAnSvgFile) {
  const ProgramResult result =
      RunOrb360({"evaluate", Truth(), Estimate(), "--plot", folder_ / "plot.svg"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(ReadText(folder_ / "plot.svg"), StartsWith("<svg "));
}

TEST_F(EvaluateTest, MistakesAreOneLine) {
  const auto error = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = RunOrb360(arguments);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(error({"evaluate", folder_ / "absent", Estimate()}), HasSubstr("absent: no such"));
  WriteText(folder_ / "bad.txt", "0 0 0 0 0 0 0 1\n1 2 3\n");
  EXPECT_THAT(error({"evaluate", Truth(), folder_ / "bad.txt"}), HasSubstr("bad.txt:2: "));
  std::vector<StampedPose> later = TexturedRoom::Trajectory(kFrames, 20.0);
  for (StampedPose& pose : later) pose.timestamp += 1000.0;
  WriteTrajectory(folder_ / "later.txt", later);
  EXPECT_THAT(error({"evaluate", Truth(), folder_ / "later.txt"}),
              HasSubstr("0 of its 60 poses have a time in common"));
  WriteText(folder_ / "summary.json", R"({"frames": 60, "map_changes": ["late"]})");
  EXPECT_THAT(error({"evaluate", folder_.path(), folder_.path()}), HasSubstr("`map_changes`"));
  EXPECT_THAT(error({"evaluate", Truth(), Estimate(), "--plot", folder_ / "no" / "plot.svg"}),
              HasSubstr("cannot be written"));
}

TEST_F(EvaluateTest, TellsHowNearTheCloudIsToTheTrueSurface) {
  // A sphere of 3 m around the first camera, and a cloud 5 cm inside of its lower half.
  std::filesystem::create_directory(folder_ / "depth");
  WriteDepthImage(folder_ / "depth" / "000000.png", cv::Mat(128, 256, CV_32FC1, cv::Scalar(3.0f)));
  const std::vector<StampedPose> truth = ReadTrajectory(Truth());
  WriteTrajectory(Estimate(), truth);
  EXPECT_FALSE(Report(folder_.path(), folder_.path()).contains("cloud"));
  SurfacePlyWriter writer(folder_ / "cloud.ply", 0.05);
  for (double latitude = -1.57; latitude < 0.0; latitude += 0.02) {
    for (double longitude = -3.14; longitude < 3.14; longitude += 0.02 / std::cos(latitude)) {
      const Eigen::Vector3d ray(std::cos(latitude) * std::cos(longitude),
                                std::cos(latitude) * std::sin(longitude), std::sin(latitude));
      const Eigen::Vector3d point = truth[0].world_from_camera * (2.95 * ray);
      writer.Append(std::vector<SurfacePoint>{{point.cast<float>(), {0, 0, 1}, {}, 1.0f}});
    }
  }
  writer.Commit();
  const nlohmann::json cloud = Report(folder_.path(), folder_.path())["cloud"];
  EXPECT_NEAR(cloud["median_distance"], 0.05, 0.01);
  EXPECT_EQ(cloud["accuracy_10cm"], 1.0);
  EXPECT_NEAR(cloud["completeness_10cm"], 0.5, 0.05);
  EXPECT_THAT(RunOrb360({"evaluate", folder_.path(), folder_.path()}).out,
              HasSubstr("accuracy, nearer than 10 cm"));
}

}  // namespace
}  // namespace orb360
