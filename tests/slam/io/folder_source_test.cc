#include "slam/io/folder_source.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/slam/io/jpeg_with_metadata.h"
#include "tests/slam/io/video/write_video.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  std::vector<std::string> names = {"img10", "img9", "img09b", "a2b10", "a2b9", "img", "img1"};
  std::ranges::sort(names, NaturalLess);
  EXPECT_THAT(names,
              testing::ElementsAre("a2b9", "a2b10", "img", "img1", "img9", "img09b", "img10"));
}

TEST(NaturalOrder, IsAStrictTotalOrder) {
  const std::vector<std::string> names = {"1", "01", "001", "", "a", "a1", "a01", "2", "10", "0"};
  for (const std::string& a : names) {
    EXPECT_FALSE(NaturalLess(a, a)) << a;
    for (const std::string& b : names) {
      EXPECT_EQ(NaturalLess(a, b), a != b && !NaturalLess(b, a)) << a << " and " << b;
    }
  }
}

const cv::Size kSize(128, 64);

cv::Mat Gray(int value, cv::Size size = kSize) {
  return cv::Mat(size, CV_8UC3, cv::Scalar::all(value));
}

std::vector<int> GrayValues(FolderSource& source) {
  std::vector<int> values;
  while (const std::optional<Frame> frame = source.Read()) {
    if (frame->image.empty()) continue;
    values.push_back(frame->image.at<cv::Vec3b>(32, 64)[0]);
  }
  return values;
}

TEST(FolderTimes, AreThoseOfExifWhereAllImagesHaveOne) {
  const TempFolder folder;
  WriteJpeg(folder / "1.jpg", Gray(50), ExifSegment("2024:02:29 23:59:59", "5000"));
  WriteJpeg(folder / "2.jpg", Gray(60), ExifSegment("2024:03:01 00:00:01", "0000"));
  WriteJpeg(folder / "3.jpg", Gray(70), ExifSegment("2024:03:01 00:00:03", "5000"));
  FolderSource source(folder.path(), "folder");
  EXPECT_DOUBLE_EQ(source.info().frame_rate, 0.5);
  std::vector<double> times;
  while (const std::optional<Frame> frame = source.Read()) times.push_back(frame->timestamp);
  EXPECT_THAT(times, testing::ElementsAre(0.0, 1.5, 4.0));
  EXPECT_THAT(source.TakeWarnings(), testing::IsEmpty());

  FolderSource with_rate(folder.path(), "folder", 10.0);
  with_rate.Read();
  EXPECT_DOUBLE_EQ(with_rate.Read()->timestamp, 0.1);

  cv::imwrite((folder / "4.jpg").string(), Gray(80));
  FolderSource one_without(folder.path(), "folder");
  one_without.Read();
  EXPECT_DOUBLE_EQ(one_without.Read()->timestamp, 1 / 30.0);
}

TEST(FolderTimes, OrderImagesWhoseNamesContradictThem) {
  const TempFolder folder;  // the camera's counter has started again
  WriteJpeg(folder / "IMG_9999.jpg", Gray(50), ExifSegment("2024:02:29 10:00:00", "0000"));
  WriteJpeg(folder / "IMG_0001.jpg", Gray(60), ExifSegment("2024:02:29 10:00:01", "0000"));
  WriteJpeg(folder / "IMG_0002.jpg", Gray(70), ExifSegment("2024:02:29 10:00:02", "0000"));
  FolderSource source(folder.path(), "folder");
  EXPECT_THAT(GrayValues(source), testing::ElementsAre(50, 60, 70));
  EXPECT_THAT(source.TakeWarnings(), testing::ElementsAre(testing::HasSubstr("EXIF times")));
}

TEST(FolderTimes, AreNotUsedWhereTwoAreTheSame) {
  const TempFolder folder;
  for (const char* name : {"a.jpg", "b.jpg"}) {
    WriteJpeg(folder / name, Gray(50), ExifSegment("2024:02:29 10:00:00", "0000"));
  }
  FolderSource source(folder.path(), "folder");
  source.Read();
  EXPECT_DOUBLE_EQ(source.Read()->timestamp, 1 / 30.0);
}

std::string Cropped(int left) {
  return XmpSegment(
      "<rdf:Description GPano:ProjectionType=\"equirectangular\" "
      "GPano:CroppedAreaImageWidthPixels=\"64\" "
      "GPano:CroppedAreaImageHeightPixels=\"64\" GPano:FullPanoWidthPixels=\"128\" "
      "GPano:FullPanoHeightPixels=\"64\" GPano:CroppedAreaLeftPixels=\"" +
      std::to_string(left) + "\" GPano:CroppedAreaTopPixels=\"0\"/>");
}

TEST(FolderOfCroppedPanoramas, LieInTheFullSphere) {
  const TempFolder folder;
  WriteJpeg(folder / "1.jpg", Gray(90, {64, 64}), Cropped(40));
  WriteJpeg(folder / "2.jpg", Gray(90, {64, 64}), Cropped(40));
  FolderSource source(folder.path(), "folder");
  EXPECT_EQ(source.info().image_size, kSize);
  EXPECT_EQ(cv::countNonZero(source.info().coverage), 64 * 64);
  const cv::Mat image = source.Read()->image;
  ASSERT_EQ(image.size(), kSize);
  EXPECT_EQ(image.at<cv::Vec3b>(32, 39)[0], 0);
  EXPECT_EQ(image.at<cv::Vec3b>(32, 40)[0], 90);
  EXPECT_EQ(image.at<cv::Vec3b>(32, 103)[0], 90);
  EXPECT_EQ(image.at<cv::Vec3b>(32, 104)[0], 0);

  WriteJpeg(folder / "3.jpg", Gray(90, {64, 64}), Cropped(41));
  EXPECT_THAT(MessageOf<UserError>([&] { FolderSource(folder.path(), "folder"); }),
              testing::AllOf(testing::HasSubstr("3.jpg"), testing::HasSubstr("another part")));
}

TEST(FolderOfHeif, AvifIsReadAndWhatCannotBeDecodedIsTold) {
  if (!HasEncoder("libaom-av1")) GTEST_SKIP() << "this FFmpeg has no encoder of AV1";
  const TempFolder folder;
  TrackSpec spec;
  spec.images = {Gray(120)};
  spec.encoder = "libaom-av1";
  WriteVideoFile(folder / "1.avif", {spec});
  std::string heic("\0\0\0\x18", 4);
  WriteText(folder / "2.heic", heic + "ftypheicmif1heic1234" + "no boxes that FFmpeg knows");
  FolderSource source(folder.path(), "folder");
  const std::vector<int> values = GrayValues(source);
  ASSERT_EQ(values.size(), 1u);
  EXPECT_NEAR(values[0], 120, 3);
  EXPECT_THAT(source.TakeWarnings(),
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("2.heic"),
                                                  testing::HasSubstr("convert it to JPEG"))));
}

}  // namespace
}  // namespace orb360
