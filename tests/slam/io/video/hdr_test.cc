#include "slam/io/video/hdr.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

/// The 8-bit colour for a code of each channel, blue first, 0 to 1.
cv::Vec3b Mapped(const cv::Vec3d& code, HdrTransfer transfer) {
  cv::Mat image(1, 1, CV_16UC3);
  for (int i = 0; i < 3; ++i) {
    image.at<cv::Vec3w>(0, 0)[i] = static_cast<ushort>(std::lround(65535 * code[i]));
  }
  return ToneMapped(image, transfer).at<cv::Vec3b>(0, 0);
}

int Gray(double code, HdrTransfer transfer) {
  const cv::Vec3b mapped = Mapped({code, code, code}, transfer);
  EXPECT_NEAR(mapped[0], mapped[1], 1);
  EXPECT_NEAR(mapped[2], mapped[1], 1);
  return mapped[1];
}

// ITU-R BT.2408, table 1: graphics white, 203 cd/m2, is 58 % PQ and 75 % HLG, and 18 % gray,
// 26 cd/m2, is 38 % PQ and 38 % HLG.
TEST(ToneMapping, PqAndHlgAgreeOnTheLevelsOfBt2408) {
  EXPECT_NEAR(Gray(0.58, HdrTransfer::kPq), Gray(0.75, HdrTransfer::kHlg), 2);
  EXPECT_NEAR(Gray(0.38, HdrTransfer::kPq), Gray(0.38, HdrTransfer::kHlg), 2);
}

// 26 / 203 of white lies below the knee: sRGB's code of 0.128 is 0.394.
TEST(ToneMapping, KeepsWhatIsDarkerThanTheKnee) {
  EXPECT_NEAR(Gray(0.38, HdrTransfer::kPq), 255 * 0.394, 2);
  EXPECT_EQ(Gray(0.0, HdrTransfer::kPq), 0);
  EXPECT_EQ(Gray(0.0, HdrTransfer::kHlg), 0);
}

// 1000 cd/m2 is 75.2 % PQ.
TEST(ToneMapping, ReachesWhiteAtTheDisplaysPeakAndNotBefore) {
  EXPECT_EQ(Gray(0.752, HdrTransfer::kPq), 255);
  EXPECT_EQ(Gray(1.0, HdrTransfer::kPq), 255);
  EXPECT_EQ(Gray(1.0, HdrTransfer::kHlg), 255);
  EXPECT_LT(Gray(0.70, HdrTransfer::kPq), 253);
}

TEST(ToneMapping, BrighterStaysBrighter) {
  for (const HdrTransfer transfer : {HdrTransfer::kPq, HdrTransfer::kHlg}) {
    int last = 0;
    for (int i = 0; i <= 100; ++i) {
      const int gray = Gray(i / 100.0, transfer);
      EXPECT_GE(gray, last);
      last = gray;
    }
  }
}

// BT.709's red in BT.2020's primaries is (0.627, 0.069, 0.016) in linear light (BT.2087).
TEST(ToneMapping, ConvertsPrimaries) {
  const auto pq = [](double light) {  // the inverse EOTF of PQ, light in cd/m2
    const double y = std::pow(light / 10000.0, 0.1593017578125);
    return std::pow((0.8359375 + 18.8515625 * y) / (1.0 + 18.6875 * y), 78.84375);
  };
  const double light = 100.0;
  const cv::Vec3b mapped =
      Mapped({pq(0.0164 * light), pq(0.0691 * light), pq(0.6274 * light)}, HdrTransfer::kPq);
  EXPECT_NEAR(mapped[2], 255 * (1.055 * std::pow(light / 203.0, 1 / 2.4) - 0.055), 2);
  EXPECT_LE(mapped[1], 6);
  EXPECT_LE(mapped[0], 6);
}

}  // namespace
}  // namespace orb360
