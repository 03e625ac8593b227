#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

TEST(DepthImage, KeepsRangesToTwoMillimetresAndDropsWhatItCannotHold) {
  const TempFolder folder;
  const cv::Mat range =
      (cv::Mat_<float>(2, 4) << 0.0f, 1.0f, 12.346f, 255.99f, 300.0f, -3.0f, NAN, INFINITY);
  WriteDepthImage(folder / "d.png", range);
  const cv::Mat raw = cv::imread((folder / "d.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(raw.type(), CV_16UC1);
  EXPECT_EQ(raw.at<std::uint16_t>(0, 1), 256);
  const cv::Mat read = ReadDepthImage(folder / "d.png");
  ASSERT_EQ(read.type(), CV_32FC1);
  for (int column = 0; column < 4; ++column) {
    EXPECT_NEAR(read.at<float>(0, column), range.at<float>(0, column), 0.00196f);
    EXPECT_EQ(read.at<float>(1, column), 0.0f);
  }
}

TEST(FractionImage, KeepsFractionsAndClampsOthers) {
  const TempFolder folder;
  const cv::Mat fraction = (cv::Mat_<float>(1, 4) << 0.0f, 0.123456f, 1.0f, 1.5f);
  WriteFractionImage(folder / "c.png", fraction);
  const cv::Mat raw = cv::imread((folder / "c.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(raw.type(), CV_16UC1);
  EXPECT_EQ(raw.at<std::uint16_t>(0, 2), 65535);
  const cv::Mat read = ReadFractionImage(folder / "c.png");
  ASSERT_EQ(read.type(), CV_32FC1);
  for (int column = 0; column < 3; ++column) {
    EXPECT_NEAR(read.at<float>(0, column), fraction.at<float>(0, column), 8e-6f);
  }
  EXPECT_EQ(read.at<float>(0, 3), 1.0f);
  EXPECT_THAT(MessageOf<UserError>([&] { ReadFractionImage(folder / "absent.png"); }),
              testing::HasSubstr("absent.png: is not an image of fractions"));
}

TEST(SourceImage, KeepsSourcesAndRefusesOtherNumbers) {
  const TempFolder folder;
  const cv::Mat source = (cv::Mat_<std::uint8_t>(1, 5) << 0, 1, 2, 3, 4);
  WriteSourceImage(folder / "s.png", source);
  EXPECT_EQ(cv::norm(ReadSourceImage(folder / "s.png"), source, cv::NORM_INF), 0);
  WriteSourceImage(folder / "more.png", source + 1);
  WriteDepthImage(folder / "depth.png", cv::Mat(4, 8, CV_32FC1, cv::Scalar(1)));
  for (const char* name : {"more.png", "depth.png", "absent.png"}) {
    EXPECT_THAT(MessageOf<UserError>([&] { ReadSourceImage(folder / name); }),
                testing::HasSubstr(std::string(name) + ": is not an image of sources"));
  }
}

TEST(DepthImage, RefusesAnImage) {
  const TempFolder folder;
  cv::imwrite((folder / "rgb.png").string(), cv::Mat(4, 8, CV_8UC3, cv::Scalar(1, 2, 3)));
  for (const char* name : {"rgb.png", "absent.png"}) {
    EXPECT_THAT(MessageOf<UserError>([&] { ReadDepthImage(folder / name); }),
                testing::HasSubstr(std::string(name) + ": is not a depth image"));
  }
}

}  // namespace
}  // namespace orb360
