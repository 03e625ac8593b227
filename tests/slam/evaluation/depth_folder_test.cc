#include "slam/evaluation/depth_folder.h"

#include <filesystem>

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
