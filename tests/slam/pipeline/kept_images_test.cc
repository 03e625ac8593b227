#include "slam/pipeline/kept_images.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

class KeptImagesTest : public testing::Test {
 protected:
  cv::Mat Image() const { return {64, 128, CV_8UC3, cv::Scalar::all(90)}; }
  static Rigid3 At(double place) { return {Eigen::Quaterniond::Identity(), {place, 0, 0}}; }

  TempFolder folder_;
  KeptImages images_{folder_ / "images", {64, 32}, true};
};

TEST_F(KeptImagesTest, KeepsThoseOfAMovingCameraInTheWantedSize) {
  images_.KeepTracked(0, Image(), At(0.0), 5.0);
  images_.KeepTracked(1, Image(), At(0.05), 5.0);
  images_.KeepTracked(2, Image(), At(0.11), 5.0);
  images_.KeepTracked(3, Image(), At(0.15), 5.0);
  images_.Flush();
  EXPECT_TRUE(images_.store().Contains(0));
  EXPECT_FALSE(images_.store().Contains(1));
  EXPECT_TRUE(images_.store().Contains(2));
  EXPECT_FALSE(images_.store().Contains(3));
  EXPECT_EQ(images_.store().Get(0).size(), cv::Size(64, 32));
}

TEST_F(KeptImagesTest, KeepsEveryKeyframeWhetherOrNotTheCameraMoves) {
  images_.KeepTracked(0, Image(), At(0), 5.0);
  images_.KeepKeyframe(0, Image());
  images_.KeepTracked(1, Image(), At(0), 5.0);
  images_.KeepKeyframe(1, Image());
  images_.Flush();
  EXPECT_TRUE(images_.store().Contains(0));
  EXPECT_TRUE(images_.store().Contains(1));
}

TEST_F(KeptImagesTest, KeepsOnlyKeyframesAndTheFirstOfAMapWithoutThoseBetween) {
  KeptImages images(folder_ / "few", {64, 32}, false);
  for (int i = 0; i < 4; ++i) images.KeepTracked(i, Image(), At(i), 5.0);
  images.KeepKeyframe(3, Image());
  images.Flush();
  EXPECT_TRUE(images.store().Contains(0));
  EXPECT_FALSE(images.store().Contains(1));
  EXPECT_FALSE(images.store().Contains(2));
  EXPECT_TRUE(images.store().Contains(3));
}

TEST_F(KeptImagesTest, KeepsTheFirstAndTheNewestFramesWithoutAPose) {
  for (int i = 0; i < 103; ++i) images_.KeepUnplaced(i, Image());
  images_.KeepTracked(103, Image(), At(0), 5.0);
  for (int i = 104; i < 110; ++i) images_.KeepUnplaced(i, Image());
  images_.Flush();
  EXPECT_TRUE(images_.store().Contains(0));  // Perhaps the reference of the first map.
  EXPECT_FALSE(images_.store().Contains(1));
  EXPECT_FALSE(images_.store().Contains(2));
  for (int i = 3; i < 110; ++i) EXPECT_TRUE(images_.store().Contains(i)) << i;
}

TEST_F(KeptImagesTest, TheFirstFrameOfTheNextMapIsKeptThoughTheCameraHasNotMoved) {
  images_.KeepTracked(0, Image(), At(0), 5.0);
  images_.KeepUnplaced(1, Image());
  images_.KeepTracked(2, Image(), At(0), 5.0);
  images_.KeepTracked(3, Image(), At(0), 5.0);
  images_.Flush();
  EXPECT_TRUE(images_.store().Contains(2));
  EXPECT_FALSE(images_.store().Contains(3));
}

TEST_F(KeptImagesTest, ADiskThatTakesNoImageIsNotedAndLosesTheOthers) {
  images_.KeepTracked(0, Image(), At(0), 5.0);
  images_.Flush();
  EXPECT_EQ(images_.failure(), nullptr);
  // A folder in the place of the file cannot be replaced by it.
  std::filesystem::create_directories(folder_ / "images" / "1.jpg" / "in the way");
  for (int i = 1; i < 4; ++i) EXPECT_NO_THROW(images_.KeepTracked(i, Image(), At(i), 5.0));
  images_.Flush();
  ASSERT_NE(images_.failure(), nullptr);
  EXPECT_THROW(std::rethrow_exception(images_.failure()), UserError);
  EXPECT_FALSE(images_.store().Contains(0));
  EXPECT_FALSE(images_.store().Contains(3));
}

}  // namespace
}  // namespace orb360
