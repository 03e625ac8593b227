#include "apps/town/sequence/exr_image.h"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

TEST(WriteExrImage, AnotherReaderFindsTheSameNumbers) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);  // OpenCV reads them only if told so
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("exr_test_" + std::to_string(getpid()) + ".exr");
  cv::Mat1f image(5, 7);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column)
      image(row, column) = 1234.5678F / static_cast<float>(1 + row * 7 + column);
  }
  image(4, 6) = 0;
  WriteExrImage(path, image);
  cv::Mat found = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  std::filesystem::remove(path);
  ASSERT_EQ(found.size(), image.size());
  ASSERT_EQ(found.depth(), CV_32F);
  cv::Mat grey;
  cv::extractChannel(found, grey, 0);
  EXPECT_EQ(cv::norm(grey, image, cv::NORM_INF), 0);
}

TEST(WriteExrImage, RefusesAPlaceThatCannotBeWritten) {
  EXPECT_THROW(WriteExrImage("/dev/null/range.exr", cv::Mat1f(2, 2, 1.0F)), UserError);
}

}  // namespace
}  // namespace orb360::town
