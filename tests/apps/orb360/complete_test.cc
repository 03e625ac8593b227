#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/sparse_file.h"
#include "tests/apps/orb360/program.h"
#include "tests/apps/orb360/run_fixture.h"
#include "tests/nn/graph/network_builder.h"
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A network that takes images with sides of multiples of 8: the mean of the points' logarithms
/// around each pixel.
class CompleteTest : public testing::Test {
 protected:
  CompleteTest() {
    nn::NetworkBuilder net(8);
    net.Input("image", 3);
    net.Input("depth", 1);
    net.Input("confidence", 1);
    net.Node("points", "median_log", {"depth", "confidence"}, nlohmann::json::object(), 3);
    net.NormalizedConvolution("mean", "points", "points.1", 1, 1, 15);
    net.weights.back().values = {0};
    net.Output("log_depth", "mean");
    net.Output("confidence", "mean.1");
    net.Output("scale", "points.2");
    net.Write(Path("net.h5"));

    image_ = cv::Mat(20, 40, CV_8UC3, cv::Scalar(10, 20, 30));
    cv::imwrite(Path("image.png"), image_);
    range_ = cv::Mat::zeros(20, 40, CV_32F);
    range_.at<float>(10, 20) = 6.5f;
    WriteDepthImage(Path("sparse.png"), range_);
  }

  std::string Path(const std::string& name) const { return folder_ / name; }

  TempFolder folder_;
  cv::Mat image_;
  cv::Mat range_;
};

TEST_F(CompleteTest, MakesADepthImageDense) {
  const ProgramResult result =
      RunOrb360({"complete", "--image", Path("image.png"), "--sparse", Path("sparse.png"),
                 "--weights", Path("net.h5"), "--out", Path("dense.png")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("dense.png"), HasSubstr("dense_confidence.png")));
  const cv::Mat dense = ReadDepthImage(Path("dense.png"));
  ASSERT_EQ(dense.size(), image_.size());
  // One point: its depth everywhere.
  EXPECT_EQ(cv::countNonZero(dense != 6.5f), 0);
  const cv::Mat confidence = cv::imread(Path("dense_confidence.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(confidence.type(), CV_16UC1);
  ASSERT_EQ(confidence.size(), image_.size());
  // Known near the point and nowhere else.
  EXPECT_GT(confidence.at<std::uint16_t>(10, 20), 0);
  EXPECT_EQ(confidence.at<std::uint16_t>(10, 0), 0);
}

TEST_F(CompleteTest, TellsInWhichTypeItMultipliesAndWhyNot) {
  const auto complete = [&](const std::string& precision) {
    return RunOrb360({"complete", "--image", Path("image.png"), "--sparse", Path("sparse.png"),
                      "--weights", Path("net.h5"), "--out", Path("dense.png"), "--json",
                      "--precision", precision});
  };
  const ProgramResult floats = complete("float");
  ASSERT_EQ(floats.status, 0) << floats.err;
  EXPECT_EQ(nlohmann::json::parse(floats.out)[0]["precision"], "float");
  // The network has no ranges of inputs.
  const ProgramResult bytes = complete("int8");
  EXPECT_EQ(bytes.status, 1);
  EXPECT_THAT(bytes.err, AllOf(IsOneLine(), HasSubstr("compute with 32 bits")));
  const ProgramResult chosen = complete("auto");
  ASSERT_EQ(chosen.status, 0) << chosen.err;
  EXPECT_NE(nlohmann::json::parse(chosen.out)[0]["precision"], "int8");
  EXPECT_NE(complete("double").status, 0);
}

TEST_F(CompleteTest, TakesWhatRunHasSaved) {
  SparseSample sample;
  sample.image = image_;
  sample.sparse = {range_, cv::Mat(range_.size(), CV_32F, cv::Scalar(0.25))};
  WriteSparseSample(Path("000012.h5"), sample);
  const ProgramResult result =
      RunOrb360({"complete", "--sparse", Path("000012.h5"), "--weights", Path("net.h5"), "--out",
                 Path("dense.png"), "--threads", "1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(cv::countNonZero(ReadDepthImage(Path("dense.png")) != 6.5f), 0);
}

TEST_F(CompleteTest, CompletesAFolderAndTellsWhatItWrote) {
  // As the other, and it takes red for the ground and tells how high the camera is.
  nn::NetworkBuilder net(8);
  net.Input("image", 3);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("points", "median_log", {"depth", "confidence"}, nlohmann::json::object(), 3);
  net.NormalizedConvolution("mean", "points", "points.1", 1, 1, 15);
  net.weights.back().values = {0};
  net.Node("red", "slice", {"image"}, {{"first", 0}, {"count", 1}});
  net.Node("none", "affine", {"points.2"}, {{"scale", 0.0}, {"offset", 0.0}});
  net.Output("log_depth", "mean");
  net.Output("confidence", "mean.1");
  net.Output("scale", "points.2");
  net.Output("ground", "red");
  net.Output("log_metric_scale", "none");
  net.Write(Path("net.h5"));
  std::filesystem::create_directory(Path("sparse"));
  for (const auto& [name, range] : {std::pair{"b", 4.0f}, std::pair{"a", 2.0f}}) {
    SparseSample sample;
    sample.image = cv::Mat(16, 32, CV_8UC3, cv::Scalar(0, 0, 51));
    sample.sparse = {cv::Mat::zeros(16, 32, CV_32F), cv::Mat::zeros(16, 32, CV_32F)};
    sample.sparse.range.at<float>(8, 16) = range;
    sample.sparse.confidence.at<float>(8, 16) = 0.5f;
    WriteSparseSample(Path("sparse/" + std::string(name) + ".h5"), sample);
  }
  const ProgramResult result = RunOrb360({"complete", "--sparse", Path("sparse"), "--weights",
                                          Path("net.h5"), "--out", Path("dense"), "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json told = nlohmann::json::parse(result.out);
  ASSERT_EQ(told.size(), 2);
  const float expected[] = {2, 4};      // by name
  constexpr int kOneFifth = 65535 / 5;  // of what 16 bits hold
  for (std::size_t i = 0; i < 2; ++i) {
    const cv::Mat depth = ReadDepthImage(told[i]["depth"].get<std::string>());
    EXPECT_EQ(cv::countNonZero(depth != expected[i]), 0);
    const cv::Mat ground = cv::imread(told[i]["ground"].get<std::string>(), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(cv::countNonZero(ground != kOneFifth), 0);
    // The median of the points is a height of the camera.
    EXPECT_NEAR(told[i]["camera_height_guess"].get<double>(), expected[i], 1e-6);
  }
  EXPECT_TRUE(std::filesystem::exists(Path("dense/a_confidence.png")));
  EXPECT_TRUE(std::filesystem::exists(Path("dense/b.png")));

  std::filesystem::create_directory(Path("empty"));
  const ProgramResult empty = RunOrb360(
      {"complete", "--sparse", Path("empty"), "--weights", Path("net.h5"), "--out", Path("dense")});
  EXPECT_EQ(empty.status, 1);
  EXPECT_THAT(empty.err, HasSubstr("has no .h5 file"));
  const ProgramResult image =
      RunOrb360({"complete", "--sparse", Path("sparse"), "--image", Path("image.png"), "--weights",
                 Path("net.h5"), "--out", Path("dense")});
  EXPECT_THAT(image.err, HasSubstr("--image is for one file"));
}

TEST_F(CompleteTest, SaysWhatIsWrong) {
  const auto error = [&](const std::string& image, const std::string& sparse,
                         const std::string& weights) {
    const ProgramResult result =
        RunOrb360({"complete", "--image", Path(image), "--sparse", Path(sparse), "--weights",
                   Path(weights), "--out", Path("dense.png")});
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(Path("dense.png")));
    return result.err;
  };
  EXPECT_THAT(error("absent.png", "sparse.png", "net.h5"), HasSubstr("absent.png"));
  EXPECT_THAT(error("image.png", "absent.png", "net.h5"), HasSubstr("no such file"));
  EXPECT_THAT(error("image.png", "image.png", "net.h5"), HasSubstr("is not a depth image"));
  EXPECT_THAT(error("image.png", "sparse.png", "image.png"),
              HasSubstr("is not a network of orb360"));
  WriteDepthImage(Path("small.png"), range_.rowRange(0, 10));
  EXPECT_THAT(error("image.png", "small.png", "net.h5"),
              HasSubstr("40x10, but the image is 40x20"));
  const ProgramResult without = RunOrb360({"complete", "--sparse", Path("sparse.png"), "--weights",
                                           Path("net.h5"), "--out", Path("dense.png")});
  EXPECT_THAT(without.err, HasSubstr("give one with --image"));
}

TEST_F(CompleteTest, WeightsInspectShowsWhatIsInAFile) {
  const ProgramResult result =
      RunOrb360({"weights", "inspect", Path("net.h5"), "--size", "64", "32"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("input   image  3x32x64"));
  EXPECT_THAT(result.out, HasSubstr("output  scale  1x1x1"));
  EXPECT_THAT(result.out, HasSubstr("parameters       226"));  // 15 x 15 and a bias
  // Two sums of 225 products at each of 2048 pixels.
  EXPECT_THAT(result.out,
              testing::ContainsRegex("mean +normalized_convolution +1x32x64 +226 +0.92"));
  EXPECT_THAT(result.out, HasSubstr("\"seed\": 1"));
  EXPECT_THAT(result.out, testing::ContainsRegex("[0-9.]+ MB of activations"));
}

TEST_F(CompleteTest, WeightsInspectRefusesSizesThatTheNetworkDoesNotTake) {
  const ProgramResult result =
      RunOrb360({"weights", "inspect", Path("net.h5"), "--size", "60", "30"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("multiples of 8"));
}

}  // namespace
}  // namespace orb360
