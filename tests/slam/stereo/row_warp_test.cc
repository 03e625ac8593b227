#include "slam/stereo/row_warp.h"

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"

namespace orb360 {
namespace {

TEST(WarpRows, SamplesBetweenPixelsAndTellsWhatIsOutsideOnEveryInstructionSet) {
  constexpr int kWidth = 37;  // no multiple of any vector
  cv::Mat image(2, kWidth, CV_32F);
  cv::Mat bytes(2, kWidth, CV_8U);
  cv::Mat disparity(2, kWidth, CV_32F);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at<float>(y, x) = 3.0f * static_cast<float>(x) + static_cast<float>(y);
      bytes.at<uint8_t>(y, x) = static_cast<uint8_t>(4 * x + y);
      disparity.at<float>(y, x) = y == 0 ? 1.25f : -2.5f;
    }
  }
  ForEachDispatchTarget([&] {
    const WarpedRows warped = WarpRows(image, disparity);
    const WarpedRows warped_bytes = WarpRows(bytes, disparity);
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float column = static_cast<float>(x) + disparity.at<float>(y, x);
        const bool is_outside = column < 0 || column > kWidth - 1;
        const float inside = std::min(std::max(column, 0.0f), kWidth - 1.0f);
        EXPECT_EQ(warped.is_outside.at<uint8_t>(y, x), is_outside ? 255 : 0) << x;
        EXPECT_NEAR(warped.image.at<float>(y, x), 3 * inside + static_cast<float>(y), 1e-4) << x;
        EXPECT_NEAR(warped_bytes.image.at<uint8_t>(y, x), 4 * inside + static_cast<float>(y), 0.5);
      }
    }
  });
}

}  // namespace
}  // namespace orb360
