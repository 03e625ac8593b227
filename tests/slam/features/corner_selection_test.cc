#include "slam/features/corner_selection.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace orb360 {
namespace {

constexpr int kCount = 400;
constexpr uint8_t kMinScore = 8;

// Noise of some pixels' size, stronger in the western half.
cv::Mat Texture() {
  cv::Mat image(256, 512, CV_8U);
  std::mt19937 random(3);
  for (int y = 0; y < image.rows; y += 4) {
    for (int x = 0; x < image.cols; x += 4) {
      const int contrast = x < image.cols / 2 ? 120 : 50;
      const auto value = static_cast<uint8_t>(128 + static_cast<int>(random() % contrast));
      image(cv::Rect(x, y, 4, 4)).setTo(value);
    }
  }
  return image;
}

std::vector<Corner> Select(const cv::Mat& image, const cv::Mat& mask = {}) {
  std::vector<PyramidLevel> levels;
  BuildSpherePyramid(image, 1, &levels);
  std::vector<BandMaxima> maxima;
  for (int index = 0; index < kSphereBands; ++index) {
    SphereBand band;
    CutBand(levels[0], index, &band);
    maxima.push_back(FindMaxima(levels[0], band, kCount, kMinScore, mask));
  }
  return SelectCorners(maxima, image.cols, kCount);
}

TEST(CornerSelection, FindsTheFourCornersOfASquare) {
  cv::Mat image(256, 512, CV_8U, cv::Scalar(60));
  image(cv::Rect(200, 130, 12, 12)).setTo(200);
  cv::GaussianBlur(image, image, {}, 1.0);  // sharp edges would give plateaus of equal scores
  const std::vector<Corner> corners = Select(image);
  for (const auto& [u, v] : {std::pair(200, 130), {212, 130}, {200, 142}, {212, 142}}) {
    EXPECT_TRUE(std::any_of(corners.begin(), corners.end(),
                            [u = u, v = v](const Corner& c) {
                              return std::abs(c.u - u) < 2.0 && std::abs(c.v - v) < 2.0;
                            }))
        << u << ' ' << v;
  }
  EXPECT_EQ(corners.size(), 4u);
}

TEST(CornerSelection, GivesAboutTheNumberAskedForInRowOrder) {
  const std::vector<Corner> corners = Select(Texture());
  EXPECT_GE(corners.size(), static_cast<size_t>(kCount));
  EXPECT_LT(corners.size(), 1.2 * kCount);
  EXPECT_TRUE(std::is_sorted(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return a.y != b.y ? a.y < b.y : a.u < b.u;
  }));
}

TEST(CornerSelection, DistributesBySolidAngleNotByStrengthOfZones) {
  cv::Mat image = Texture();
  image.rowRange(0, 128) = 128 + 0.3 * (image.rowRange(0, 128) - 128);  // the sky is pale
  const std::vector<Corner> corners = Select(image);
  const auto north =
      std::count_if(corners.begin(), corners.end(), [](const Corner& c) { return c.v < 128; });
  EXPECT_NEAR(static_cast<double>(north) / static_cast<double>(corners.size()), 0.5, 0.1);
  // Within 30 degrees of the north pole: 6.7 % of the sphere.
  const auto polar = std::count_if(corners.begin(), corners.end(),
                                   [](const Corner& c) { return c.v < 256 / 6.0; });
  EXPECT_LT(static_cast<double>(polar) / static_cast<double>(corners.size()), 0.15);
}

TEST(CornerSelection, WithinAZoneTheStrongestWinUpToFourTimesTheirQuota) {
  const std::vector<Corner> corners = Select(Texture());
  const auto west =
      std::count_if(corners.begin(), corners.end(), [](const Corner& c) { return c.u < 256; });
  EXPECT_GT(static_cast<double>(west), 0.7 * static_cast<double>(corners.size()));
}

TEST(CornerSelection, LeavesOutWhatIsMasked) {
  cv::Mat mask(64, 128, CV_8U, cv::Scalar(255));
  mask(cv::Rect(32, 16, 40, 30)).setTo(0);
  for (const Corner& corner : Select(Texture(), mask)) {
    const int x = static_cast<int>((corner.x + 0.5) / 4);
    if (corner.y / 4 < 16 || corner.y / 4 >= 46) continue;
    if (corner.band < 4 || corner.band > 11) continue;  // columns of compressed bands
    EXPECT_TRUE(x < 32 || x >= 72) << corner.u << ' ' << corner.v;
  }
}

}  // namespace
}  // namespace orb360
