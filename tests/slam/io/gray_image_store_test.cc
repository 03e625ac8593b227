#include "slam/io/gray_image_store.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(GrayImageStore, GivesImagesBackWithSmallErrors) {
  const TempFolder folder;
  const GrayImageStore store(folder / "images");
  cv::Mat gray(64, 128, CV_8U);
  cv::randu(gray, 0, 256);
  cv::GaussianBlur(gray, gray, {}, 2);
  store.Put(7, gray);
  EXPECT_TRUE(store.Contains(7));
  EXPECT_FALSE(store.Contains(8));
  const cv::Mat read = store.Get(7);
  ASSERT_EQ(read.type(), CV_8UC1);
  ASSERT_EQ(read.size(), gray.size());
  EXPECT_LT(cv::norm(read, gray, cv::NORM_INF), 6);
}

TEST(GrayImageStore, AnImageThatIsGoneOrCutOffIsAnError) {
  const TempFolder folder;
  const GrayImageStore store(folder / "images");
  EXPECT_THROW(store.Get(1), UserError);
  store.Put(1, cv::Mat(64, 128, CV_8U, cv::Scalar(90)));
  std::filesystem::resize_file(folder / "images" / "1.jpg", 40);
  EXPECT_THROW(store.Get(1), UserError);
  std::filesystem::remove_all(folder / "images");
  EXPECT_THROW(store.Put(1, cv::Mat(64, 128, CV_8U, cv::Scalar(90))), UserError);
}

TEST(GrayImageStore, ContractsAreChecked) {
  const TempFolder folder;
  const GrayImageStore store(folder / "images");
  EXPECT_THROW(store.Put(1, cv::Mat(64, 128, CV_8UC3)), ContractError);
  EXPECT_THROW(store.Put(1, cv::Mat()), ContractError);
}

}  // namespace
}  // namespace orb360
