#include "slam/io/image_store.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(ImageStore, GivesImagesBackWithSmallErrors) {
  const TempFolder folder;
  const ImageStore store(folder / "images");
  cv::Mat image(64, 128, CV_8UC3);
  cv::randu(image, cv::Scalar::all(0), cv::Scalar::all(256));
  cv::GaussianBlur(image, image, {}, 4);
  store.Put(7, image);
  EXPECT_TRUE(store.Contains(7));
  EXPECT_FALSE(store.Contains(8));
  const cv::Mat read = store.Get(7);
  ASSERT_EQ(read.type(), CV_8UC3);
  ASSERT_EQ(read.size(), image.size());
  EXPECT_LT(cv::norm(read, image, cv::NORM_L1) / static_cast<double>(3 * image.total()), 2);
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(store.GetGray(7).type(), CV_8UC1);
  EXPECT_LT(cv::norm(store.GetGray(7), gray, cv::NORM_INF), 6);
}

TEST(ImageStore, RemovesImages) {
  const TempFolder folder;
  const ImageStore store(folder / "images");
  store.Put(1, cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90)));
  store.Remove(1);
  store.Remove(2);
  EXPECT_FALSE(store.Contains(1));
  store.Put(3, cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90)));
  store.Put(4, cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90)));
  store.Clear();
  EXPECT_FALSE(store.Contains(3));
  EXPECT_FALSE(store.Contains(4));
}

TEST(ImageStore, AnImageThatIsGoneOrCutOffIsAnError) {
  const TempFolder folder;
  const ImageStore store(folder / "images");
  EXPECT_THROW(store.Get(1), UserError);
  store.Put(1, cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90)));
  std::filesystem::resize_file(folder / "images" / "1.jpg", 40);
  EXPECT_THROW(store.Get(1), UserError);
  EXPECT_THROW(store.GetGray(1), UserError);
  std::filesystem::remove_all(folder / "images");
  EXPECT_THROW(store.Put(1, cv::Mat(64, 128, CV_8UC3, cv::Scalar::all(90))), UserError);
}

TEST(ImageStore, ContractsAreChecked) {
  const TempFolder folder;
  const ImageStore store(folder / "images");
  EXPECT_THROW(store.Put(1, cv::Mat(64, 128, CV_8U)), ContractError);
  EXPECT_THROW(store.Put(1, cv::Mat()), ContractError);
}

}  // namespace
}  // namespace orb360
