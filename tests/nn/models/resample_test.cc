#include "nn/models/resample.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360::nn {
namespace {

using ::testing::ElementsAre;

std::vector<float> Resampled(const std::vector<float>& from, ImageSize from_size,
                             ImageSize to_size) {
  std::vector<float> to(static_cast<std::size_t>(to_size.height) * to_size.width, -1);
  ResampleBilinear(from, from_size, to, to_size);
  return to;
}

TEST(Resample, TheSameSizeIsTheSameImage) {
  std::vector<float> image(6 * 11);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<float>(i * i);
  EXPECT_EQ(Resampled(image, {6, 11}, {6, 11}), image);
}

TEST(Resample, ColumnsContinueAtTheOtherSideAndRowsRepeat) {
  // Twice as wide: samples at -1/4, 1/4, 3/4, 5/4 of two columns.
  EXPECT_THAT(Resampled({0, 4}, {1, 2}, {1, 4}), ElementsAre(1, 1, 3, 3));
  EXPECT_THAT(Resampled({0, 4}, {2, 1}, {4, 1}), ElementsAre(0, 1, 3, 4));
}

TEST(Resample, KeepsSmoothImagesOfTheSphere) {
  const auto wave = [](ImageSize size) {
    std::vector<float> image;
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        const double longitude = 2 * std::numbers::pi * (u + 0.5) / size.width;
        const double latitude = std::numbers::pi * (v + 0.5) / size.height;
        image.push_back(static_cast<float>(std::sin(longitude) + std::cos(latitude)));
      }
    }
    return image;
  };
  const ImageSize from{96, 200};
  const ImageSize to{128, 192};
  const std::vector<float> expected = wave(to);
  const std::vector<float> actual = Resampled(wave(from), from, to);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // Curvature times the squared step over eight, in both directions.
    ASSERT_NEAR(actual[i], expected[i], 3e-4) << i;
  }
}

TEST(Resample, SmallerImagesAreMeansOfWhatTheyCover) {
  std::vector<float> image(16 * 32);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<float>(i % 7 * i);
  std::vector<float> to(4 * 8);
  ResampleImage(image, {16, 32}, to, {4, 8});
  for (int v = 0; v < 4; ++v) {
    for (int u = 0; u < 8; ++u) {
      float sum = 0;
      for (int i = 0; i < 16; ++i) {
        sum += image[static_cast<std::size_t>((4 * v + i / 4) * 32 + 4 * u + i % 4)];
      }
      EXPECT_FLOAT_EQ(to[static_cast<std::size_t>(8 * v + u)], sum / 16);
    }
  }
  // Sizes that are no halves, and larger ones, as ResampleBilinear has them.
  for (const ImageSize size : {ImageSize{10, 20}, ImageSize{20, 40}}) {
    std::vector<float> other(static_cast<std::size_t>(size.height) * size.width);
    ResampleImage(image, {16, 32}, other, size);
    EXPECT_EQ(other, Resampled(image, {16, 32}, size));
  }
}

TEST(Resample, PointsMoveToThePixelThatHoldsThem) {
  const std::vector<float> depth = {0, 5, 0, 0, 3, 0};
  const std::vector<float> confidence = {0, 0.5f, 0, 0, 0.75f, 0};
  std::vector<float> to_depth(12, -1);
  std::vector<float> to_confidence(12, -1);
  ResamplePoints(depth, confidence, {2, 3}, to_depth, to_confidence, {2, 6});
  EXPECT_THAT(to_depth, ElementsAre(0, 0, 0, 5, 0, 0, 0, 0, 0, 3, 0, 0));
  EXPECT_THAT(to_confidence, ElementsAre(0, 0, 0, 0.5f, 0, 0, 0, 0, 0, 0.75f, 0, 0));
}

TEST(Resample, TheNearestOfSeveralPointsStays) {
  const std::vector<float> depth = {7, 2, 9, 0};
  const std::vector<float> confidence = {0.1f, 0.2f, 0.3f, 0};
  std::vector<float> to_depth(1);
  std::vector<float> to_confidence(1);
  ResamplePoints(depth, confidence, {2, 2}, to_depth, to_confidence, {1, 1});
  EXPECT_EQ(to_depth[0], 2);
  EXPECT_EQ(to_confidence[0], 0.2f);
}

}  // namespace
}  // namespace orb360::nn
