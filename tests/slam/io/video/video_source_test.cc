#include "slam/io/video/video_source.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "tests/slam/io/video/video_fixture.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Compares at most `count` frames with what OpenCV's reader decodes, byte by byte, as stored.
void ExpectOpenCvsBytes(const std::string& path, int count) {
  cv::VideoCapture capture(path, cv::CAP_FFMPEG);
  VideoTrack track(path);
  FrameConverter converter;
  for (int i = 0; i < count; ++i) {
    cv::Mat expected;
    const bool has_frame = capture.read(expected);
    ASSERT_EQ(track.Advance(), has_frame) << i;
    if (!has_frame) return;
    const cv::Mat image = converter.ToBgr(track.frame());
    ASSERT_EQ(image.size(), expected.size());
    ASSERT_EQ(cv::norm(image, expected, cv::NORM_INF), 0.0) << i;
  }
}

TEST_F(VideoSourceTest, GivesTheBytesOfOpenCvsReaderForOrdinaryFiles) {
  for (const char* encoder : {"mpeg4", "libx264", "mjpeg"}) {
    for (const cv::Size size : {cv::Size(256, 128), cv::Size(202, 102)}) {
      if (!HasEncoder(encoder)) continue;
      TrackSpec spec = Scenes(12, size);
      spec.encoder = encoder;
      if (spec.encoder == std::string("mjpeg")) spec.format = AV_PIX_FMT_YUVJ420P;
      SCOPED_TRACE(std::string(encoder) + " " + std::to_string(size.width));
      ExpectOpenCvsBytes(Write(spec), 100);
    }
  }
}

class SharedVideo : public testing::TestWithParam<const char*> {};

TEST_P(SharedVideo, HasTheBytesOfOpenCvsReader) {
  const std::filesystem::path path =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data" / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  ExpectOpenCvsBytes(path.string(), 60);
}

INSTANTIATE_TEST_SUITE_P(Recordings, SharedVideo,
                         testing::Values("tunnel/tunnel.mp4", "theta_walk/theta_walk.mp4"),
                         [](const auto& file) {
                           return std::filesystem::path(file.param).stem().string();
                         });

TEST_F(VideoSourceTest, ThreadsDoNotChangeTheBytesEvenOfADamagedFile) {
  TrackSpec spec = Scenes(40, {256, 128});
  if (HasEncoder("libx264")) spec.encoder = "libx264";
  Write(spec, "whole.mkv");
  std::string bytes = ReadText(folder_ / "whole.mkv");
  for (size_t at = bytes.size() / 2; at < bytes.size() / 2 + 200; ++at) bytes[at] ^= 0x55;
  WriteText(folder_ / "damaged.mkv", bytes);
  for (const char* name : {"whole.mkv", "damaged.mkv"}) {
    VideoSource one((folder_ / name).string(), 1);
    VideoSource many((folder_ / name).string(), 5);
    const std::vector<Frame> expected = ReadAll(one);
    const std::vector<Frame> frames = ReadAll(many);
    ASSERT_EQ(frames.size(), expected.size()) << name;
    EXPECT_GT(frames.size(), 20u);
    for (size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(cv::norm(frames[i].image, expected[i].image, cv::NORM_INF), 0.0) << name << i;
      EXPECT_EQ(frames[i].timestamp, expected[i].timestamp);
    }
  }
}

TEST_F(VideoSourceTest, TimesAreTheFilesAlsoWhereTheRateVaries) {
  for (const char* name : {"video.mp4", "video.mkv"}) {
    TrackSpec spec = Scenes(9, {128, 64});
    if (HasEncoder("libx264")) spec.encoder = "libx264";  // with frames that refer to later ones
    spec.times = {0, 33, 100, 110, 500, 533, 566, 900, 2000};
    VideoSource source(Write(spec, name));
    const std::vector<Frame> frames = ReadAll(source);
    ASSERT_EQ(frames.size(), 9u);
    for (size_t i = 0; i < 9; ++i) {
      EXPECT_NEAR(frames[i].timestamp, static_cast<double>(spec.times[i]) / 1000.0, 1e-3) << name;
    }
    EXPECT_THAT(source.TakeWarnings(), IsEmpty());
  }
}

TEST_F(VideoSourceTest, PixelsThatAreNotSquareMakeAFullSphere) {
  TrackSpec spec = Scenes(2, {192, 108});
  spec.sample_aspect = {9, 8};
  const auto sequence = OpenSequence(Write(spec), {});
  EXPECT_EQ(sequence->image_size(), cv::Size(216, 108));
  const cv::Mat image = sequence->Next()->image;
  cv::Mat expected;
  cv::resize(spec.images[0], expected, {216, 108});
  EXPECT_EQ(image.size(), cv::Size(216, 108));
  EXPECT_LT(cv::norm(image, expected, cv::NORM_L1) / static_cast<double>(image.total()), 12.0);
}

TEST_F(VideoSourceTest, AFullSphereIsNotScaledForASlightlyOtherShapeOfPixels) {
  TrackSpec spec = Scenes(2, {640, 322});
  spec.sample_aspect = {161, 160};
  EXPECT_EQ(VideoSource(Write(spec)).info().image_size, cv::Size(640, 322));
}

TEST_F(VideoSourceTest, TurnsAndMirrorsAsTheFileSays) {
  // A quarter turn clockwise: (p, q) is shown at (-q, p).
  TrackSpec spec = Still(Quarters({64, 128}));
  spec.display_matrix = {0, 65536, 0, -65536, 0, 0, 0, 0, 1 << 30};
  VideoSource turned(Write(spec));
  EXPECT_EQ(turned.info().image_size, cv::Size(128, 64));
  const cv::Mat image = turned.Read()->image;
  EXPECT_EQ(QuarterOf(image.at<cv::Vec3b>(16, 32)), 2);
  EXPECT_EQ(QuarterOf(image.at<cv::Vec3b>(16, 96)), 0);
  EXPECT_EQ(QuarterOf(image.at<cv::Vec3b>(48, 32)), 3);

  spec = Still(Quarters({128, 64}));
  spec.display_matrix = {-65536, 0, 0, 0, 65536, 0, 0, 0, 1 << 30};
  VideoSource mirrored(Write(spec));
  EXPECT_EQ(QuarterOf(mirrored.Read()->image.at<cv::Vec3b>(16, 32)), 1);
}

TEST_F(VideoSourceTest, AQuarterTurnOfAFullSphereIsIgnoredWithAWarning) {
  TrackSpec spec = Still(Quarters({128, 64}));
  spec.display_matrix = {0, 65536, 0, -65536, 0, 0, 0, 0, 1 << 30};
  VideoSource source(Write(spec));
  EXPECT_EQ(source.info().image_size, cv::Size(128, 64));
  EXPECT_EQ(QuarterOf(source.Read()->image.at<cv::Vec3b>(16, 32)), 0);
  EXPECT_THAT(source.TakeWarnings(),
              ElementsAre(AllOf(HasSubstr("90 degrees"), HasSubstr("not turned"))));
}

TEST_F(VideoSourceTest, ColoursFollowTheMatrixAndTheRangeOfTheFile) {
  if (!HasEncoder("libx264")) GTEST_SKIP() << "this FFmpeg has no libx264";
  for (const AVColorSpace matrix : {AVCOL_SPC_UNSPECIFIED, AVCOL_SPC_BT709}) {
    for (const AVColorRange range : {AVCOL_RANGE_UNSPECIFIED, AVCOL_RANGE_JPEG}) {
      TrackSpec spec = Still(Quarters({128, 64}));
      spec.encoder = "libx264";
      spec.matrix = matrix;
      spec.range = range;
      VideoSource source(Write(spec));
      const cv::Mat image = source.Read()->image;
      for (int i = 0; i < 4; ++i) {
        const cv::Point at(32 + 64 * (i % 2), 16 + 32 * (i / 2));
        for (int channel = 0; channel < 3; ++channel) {
          EXPECT_NEAR(image.at<cv::Vec3b>(at)[channel], spec.images[0].at<cv::Vec3b>(at)[channel],
                      4)
              << matrix << " " << range << " " << i;
        }
      }
    }
  }
}

TEST_F(VideoSourceTest, TenBitsOfHevcBecomeEight) {
  if (!HasEncoder("libx265")) GTEST_SKIP() << "this FFmpeg has no libx265";
  TrackSpec spec = Scenes(3, {256, 128});
  spec.encoder = "libx265";
  spec.format = AV_PIX_FMT_YUV420P10;
  VideoSource source(Write(spec));
  const std::vector<Frame> frames = ReadAll(source);
  ASSERT_EQ(frames.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const double mean = cv::norm(frames[i].image, spec.images[i], cv::NORM_L1) / (3.0 * 256 * 128);
    EXPECT_LT(mean, 3.0);
  }
}

// Code 0.58 of PQ is 203 cd/m2, the white of graphics, which is compressed to 0.80, sRGB's code
// 231; code 0.38 is 26 cd/m2, which stays 0.128 of white, code 100.
TEST_F(VideoSourceTest, HighDynamicRangeIsToneMapped) {
  if (!HasEncoder("libx265")) GTEST_SKIP() << "this FFmpeg has no libx265";
  cv::Mat image(128, 256, CV_16UC3, cv::Scalar::all(0.38 * 65535));
  image.colRange(128, 256) = cv::Scalar::all(0.58 * 65535);
  TrackSpec spec = Still(image);
  spec.encoder = "libx265";
  spec.format = AV_PIX_FMT_YUV420P10;
  spec.matrix = AVCOL_SPC_BT2020_NCL;
  spec.transfer = AVCOL_TRC_SMPTE2084;
  VideoSource source(Write(spec));
  const cv::Mat mapped = source.Read()->image;
  EXPECT_NEAR(mapped.at<cv::Vec3b>(64, 64)[1], 100, 3);
  EXPECT_NEAR(mapped.at<cv::Vec3b>(64, 192)[1], 231, 3);
}

TEST_F(VideoSourceTest, CountsVideoTracks) {
  WriteVideoFile(folder_ / "two.mp4", {Scenes(3, {128, 64}), Scenes(3, {64, 32})});
  EXPECT_EQ(CountVideoTracks((folder_ / "two.mp4").string()), 2);
  EXPECT_EQ(VideoTrack((folder_ / "two.mp4").string(), 1).size(), cv::Size(64, 32));
  EXPECT_THAT(MessageOf<UserError>([&] { VideoTrack((folder_ / "two.mp4").string(), 2); }),
              HasSubstr("no video track 3"));
  EXPECT_EQ(CountVideoTracks((folder_ / "absent.mp4").string()), 0);
}

}  // namespace
}  // namespace orb360
