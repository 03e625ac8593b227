#include "slam/evaluation/depth_folder.h"

#include <filesystem>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

cv::Mat Constant(float range, cv::Size size = {32, 16}) {
  return {size, CV_32FC1, cv::Scalar(range)};
}

TEST(CompareDepthFolders, PairsImagesByNameAndAddsThemUp) {
  const TempFolder truth;
  const TempFolder estimate;
  for (const char* name : {"0.png", "1.png", "2.png"}) WriteDepthImage(truth / name, Constant(10));
  WriteDepthImage(estimate / "0.png", Constant(11));
  WriteDepthImage(estimate / "2.png", Constant(13));
  WriteDepthImage(estimate / "7.png", Constant(50));
  WriteText(estimate / "notes.txt", "");
  const DepthFolderErrors result = CompareDepthFolders(truth.path(), estimate.path());
  ASSERT_EQ(result.images.size(), 2U);
  EXPECT_EQ(result.images[1].name, "2.png");
  EXPECT_NEAR(result.images[1].total.Mae(), 3.0, 1e-9);
  EXPECT_NEAR(result.errors.total.Mae(), 2.0, 1e-9);
}

TEST(CompareDepthFolders, ComparesErrorsWithTheConfidencesThatThereAre) {
  const TempFolder truth;
  const TempFolder estimate;
  const TempFolder confidence;
  for (const char* name : {"0.png", "1.png"}) WriteDepthImage(truth / name, Constant(10));
  WriteDepthImage(estimate / "0.png", Constant(11));
  WriteDepthImage(estimate / "1.png", Constant(15));
  EXPECT_FALSE(
      CompareDepthFolders(truth.path(), estimate.path(), confidence / "absent").calibration);
  WriteFractionImage(confidence / "0.png", Constant(0.8F));
  const DepthFolderErrors result =
      CompareDepthFolders(truth.path(), estimate.path(), confidence.path());
  ASSERT_TRUE(result.calibration);
  EXPECT_NEAR(result.calibration->Tenths()[4].stated, 0.25, 1e-4);
  EXPECT_NEAR(result.calibration->Tenths()[4].observed, 0.1, 1e-6);

  EXPECT_TRUE(result.by_source.empty());

  const TempFolder source;
  cv::Mat half(16, 32, CV_8UC1, cv::Scalar(static_cast<double>(RangeSource::kMeasured)));
  half.rowRange(0, 8) = static_cast<double>(RangeSource::kBoundary);
  WriteSourceImage(source / "0.png", half);
  cv::Mat range = Constant(11);
  range.rowRange(0, 8) = 14;
  WriteDepthImage(estimate / "0.png", range);
  const auto parts =
      CompareDepthFolders(truth.path(), estimate.path(), confidence.path(), source.path())
          .by_source;
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(parts.at(RangeSource::kMeasured).Mean().observed, 0.1, 1e-6);
  EXPECT_NEAR(parts.at(RangeSource::kBoundary).Mean().observed, 0.4, 1e-6);
  EXPECT_NEAR(parts.at(RangeSource::kBoundary).Mean().stated, 0.25, 1e-4);
  EXPECT_NEAR(parts.at(RangeSource::kBoundary).solid_angle(), 2 * std::numbers::pi, 0.1);

  WriteFractionImage(confidence / "1.png", Constant(0.8F, {16, 8}));
  EXPECT_THAT(MessageOf<UserError>(
                  [&] { CompareDepthFolders(truth.path(), estimate.path(), confidence.path()); }),
              AllOf(HasSubstr((confidence / "1.png").string()), HasSubstr("16x8")));
}

TEST(CompareDepthFolders, NamesAnImageOfAnotherSize) {
  const TempFolder truth;
  const TempFolder estimate;
  WriteDepthImage(truth / "0.png", Constant(10));
  WriteDepthImage(estimate / "0.png", Constant(10, {16, 8}));
  EXPECT_THAT(
      MessageOf<UserError>([&] { CompareDepthFolders(truth.path(), estimate.path()); }),
      AllOf(HasSubstr((estimate / "0.png").string()), HasSubstr("16x8"), HasSubstr("32x16")));
}

}  // namespace
}  // namespace orb360
