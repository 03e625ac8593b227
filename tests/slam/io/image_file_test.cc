#include "slam/io/image_file.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

const cv::Size kSize(96, 48);

cv::Mat Image() {
  cv::Mat image(kSize, CV_8UC3);
  cv::randu(image, 0, 256);
  return image;
}

TEST(ProbeImageSize, ReadsJpegAndPngHeaders) {
  const TempFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    cv::imwrite((folder / name).string(), Image());
    EXPECT_EQ(ProbeImageSize(folder / name), kSize) << name;
  }
  cv::imwrite((folder / "progressive.jpg").string(), Image(), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  EXPECT_EQ(ProbeImageSize(folder / "progressive.jpg"), kSize);
}

TEST(ProbeImageSize, FindsTheFrameHeaderBehindALargeApplicationSegment) {
  const TempFolder folder;
  cv::imwrite((folder / "a.jpg").string(), Image());
  std::string data = ReadText(folder / "a.jpg");
  // 40,002 bytes of APP1, as an EXIF preview takes, filled with what looks like an end of image.
  std::string segment("\xff\xe1\x9c\x42", 4);
  while (segment.size() < 40004) segment += "\xff\xd9";
  data.insert(2, segment);
  WriteText(folder / "b.jpg", data);
  EXPECT_EQ(ProbeImageSize(folder / "b.jpg"), kSize);
  EXPECT_EQ(LoadImage(folder / "b.jpg").image.size(), kSize);
  CopyTruncated(folder / "b.jpg", folder / "cut.jpg", 0.97);
  EXPECT_EQ(LoadImage(folder / "cut.jpg").problem, "is cut off");
}

TEST(ProbeImageSize, KnowsNothingOfOtherFiles) {
  const TempFolder folder;
  WriteText(folder / "empty.png", "");
  WriteText(folder / "text.jpg", "not an image");
  WriteText(folder / "short.png", "\x89PNG\r\n\x1a\n");
  for (const char* name : {"empty.png", "text.jpg", "short.png", "absent.png"}) {
    EXPECT_FALSE(ProbeImageSize(folder / name)) << name;
  }
}

TEST(LoadImage, NoPrefixOfAFileGivesAnImage) {
  const TempFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    cv::imwrite((folder / name).string(), Image());
    for (double fraction : {0.0, 0.01, 0.1, 0.5, 0.9, 0.99}) {
      CopyTruncated(folder / name, folder / "cut", fraction);
      const LoadedImage loaded = LoadImage(folder / "cut");
      EXPECT_TRUE(loaded.image.empty()) << name << ' ' << fraction;
      EXPECT_FALSE(loaded.problem.empty()) << name << ' ' << fraction;
    }
  }
}

// The image as OpenCV alone decodes it.
cv::Mat DecodedByOpenCv(const std::filesystem::path& path) {
  return cv::imread(path.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

TEST(LoadImage, JpegGivesThePixelsOfOpenCv) {
  const TempFolder folder;
  cv::Mat grey;
  cv::extractChannel(Image(), grey, 0);
  cv::imwrite((folder / "grey.jpg").string(), grey);
  cv::imwrite((folder / "low.jpg").string(), Image(), {cv::IMWRITE_JPEG_QUALITY, 40});
  cv::imwrite((folder / "progressive.jpg").string(), Image(), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  for (const char* name : {"grey.jpg", "low.jpg", "progressive.jpg"}) {
    const LoadedImage loaded = LoadImage(folder / name);
    ASSERT_EQ(loaded.image.type(), CV_8UC3) << name << loaded.problem;
    EXPECT_EQ(cv::norm(loaded.image, DecodedByOpenCv(folder / name), cv::NORM_INF), 0) << name;
  }
}

TEST(LoadImage, DamagedJpegGivesTheImageOfOpenCvOrNone) {
  const TempFolder folder;
  int num_images = 0;
  int num_problems = 0;
  for (const int progressive : {0, 1}) {
    cv::imwrite((folder / "whole.jpg").string(), Image(),
                {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    const std::string whole = ReadText(folder / "whole.jpg");
    for (size_t at = 100; at + 2 < whole.size(); at += 37) {
      std::string data = whole;
      std::copy_n("\xff\x3c", 2,
                  data.begin() + at);  // a marker that does not exist, or a wrong code
      WriteText(folder / "damaged.jpg", data);
      const LoadedImage loaded = LoadImage(folder / "damaged.jpg");
      if (loaded.image.empty()) {
        ++num_problems;
        continue;
      }
      ++num_images;
      const cv::Mat expected = DecodedByOpenCv(folder / "damaged.jpg");
      ASSERT_EQ(loaded.image.size(), expected.size()) << at;
      EXPECT_EQ(cv::norm(loaded.image, expected, cv::NORM_INF), 0) << at;
    }
  }
  EXPECT_GT(num_images, 10);
  EXPECT_GT(num_problems, 0);
}

TEST(LoadImage, JpegOfMorePixelsThanCanBeIsAProblemAndNoCrash) {
  const TempFolder folder;
  cv::imwrite((folder / "a.jpg").string(), Image());
  std::string data = ReadText(folder / "a.jpg");
  const size_t frame = data.find("\xff\xc0");  // marker, length, bits, height, width
  ASSERT_NE(frame, std::string::npos);
  data.replace(frame + 5, 4, "\x90\x90\x90\x90");  // 37008 each way: more than OpenCV takes
  WriteText(folder / "huge.jpg", data);
  EXPECT_EQ(LoadImage(folder / "huge.jpg").problem, "cannot be decoded");
}

TEST(LoadImage, FolderIsAProblemToName) {
  const TempFolder folder;
  EXPECT_FALSE(LoadImage(folder.path()).problem.empty());
}

TEST(LoadImage, FloatingPointPixelsAreAProblemToName) {
  const TempFolder folder;
  cv::imwrite((folder / "a.tiff").string(), cv::Mat(kSize, CV_32FC3, cv::Scalar(0.5, 0.5, 0.5)));
  EXPECT_EQ(LoadImage(folder / "a.tiff").problem, "has neither 8 nor 16 bits a channel");
}

TEST(IsImageFileName, IgnoresCase) {
  EXPECT_TRUE(IsImageFileName("a/b.JPG"));
  EXPECT_TRUE(IsImageFileName("b.jpeg"));
  EXPECT_FALSE(IsImageFileName("b.mp4"));
  EXPECT_FALSE(IsImageFileName("jpg"));
}

}  // namespace
}  // namespace orb360
