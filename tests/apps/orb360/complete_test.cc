#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/depth_image.h"
#include "slam/io/sparse_file.h"
#include "tests/apps/orb360/program.h"
#include "tests/nn/graph/network_builder.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A network that takes pictures with sides of multiples of 8: the mean of the points' logarithms
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
