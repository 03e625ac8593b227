#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const cv::Size kSize(128, 64);

/// An image whose brightness tells its index.
cv::Mat Numbered(int index, cv::Size size = kSize) {
  cv::Mat image(size, CV_8UC3, cv::Scalar(40 + 2 * index, 60, 80));
  cv::circle(image, {size.width * index / 100, size.height / 2}, size.height / 5, {255, 255, 255},
             -1);
  return image;
}

void WriteVideo(const std::filesystem::path& path, const char* codec, int frames, double fps = 25.0,
                cv::Size size = kSize) {
  cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), fps,
                         size);
  ASSERT_TRUE(writer.isOpened()) << path;
  for (int i = 0; i < frames; ++i) writer << Numbered(i, size);
}

void WriteImages(const TempFolder& folder, int count) {
  for (int i = 0; i < count; ++i) {
    cv::imwrite((folder / ("img" + std::to_string(i) + ".png")).string(), Numbered(i));
  }
}

std::vector<Frame> ReadAll(Sequence& sequence) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = sequence.Next()) frames.push_back(*frame);
  return frames;
}

std::vector<Frame> ReadAll(const std::filesystem::path& input,
                           const SequenceOptions& options = {}) {
  return ReadAll(*OpenSequence(input.string(), options));
}

std::vector<int> Indices(const std::vector<Frame>& frames) {
  std::vector<int> indices;
  for (const Frame& frame : frames) indices.push_back(frame.index);
  return indices;
}

std::string RefusalOf(const std::filesystem::path& input, const SequenceOptions& options = {}) {
  return MessageOf<UserError>([&] { ReadAll(input, options); });
}

class SequenceOfVideo : public testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  std::filesystem::path Path() const {
    return folder_ / (std::string("video.") + GetParam().first);
  }
  TempFolder folder_;
};

TEST_P(SequenceOfVideo, GivesEveryFrameWithItsIndexAndTime) {
  WriteVideo(Path(), GetParam().second, 40);
  const auto sequence = OpenSequence(Path().string(), {});
  EXPECT_EQ(sequence->image_size(), kSize);
  EXPECT_NEAR(sequence->frame_rate(), 25.0, 1e-9);
  const std::vector<Frame> frames = ReadAll(*sequence);
  ASSERT_THAT(frames, SizeIs(40));
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(frames[i].index, i);
    EXPECT_NEAR(frames[i].timestamp, i / 25.0, 1e-3);
    EXPECT_EQ(frames[i].image.type(), CV_8UC3);
    EXPECT_NEAR(frames[i].image.at<cv::Vec3b>(2, 2)[0], 40 + 2 * i, 8);
  }
  EXPECT_THAT(sequence->TakeWarnings(), IsEmpty());
}

// H.264 has frames that refer to later ones; of the last ones the reader does not tell the time.
INSTANTIATE_TEST_SUITE_P(Containers, SequenceOfVideo,
                         testing::Values(std::pair("avi", "MJPG"), std::pair("mp4", "mp4v"),
                                         std::pair("mkv", "mp4v"), std::pair("mp4", "avc1")),
                         [](const auto& container) {
                           return std::string(container.param.first) + "_" + container.param.second;
                         });

class SequenceOfTruncatedVideo : public SequenceOfVideo {};

TEST_P(SequenceOfTruncatedVideo, KeepsWhatWasDecodedAndSaysWhereItEnds) {
  const std::filesystem::path whole = folder_ / (std::string("whole.") + GetParam().first);
  WriteVideo(whole, GetParam().second, 60);
  CopyTruncated(whole, Path(), 0.5);
  const auto sequence = OpenSequence(Path().string(), {});
  const std::vector<Frame> frames = ReadAll(*sequence);
  EXPECT_GT(frames.size(), 15u);
  EXPECT_LT(frames.size(), 45u);
  EXPECT_THAT(sequence->TakeWarnings(),
              ElementsAre(AllOf(HasSubstr(Path().string()),
                                HasSubstr("frame " + std::to_string(frames.size()) + " of 60"))));
}

INSTANTIATE_TEST_SUITE_P(Containers, SequenceOfTruncatedVideo,
                         testing::Values(std::pair("avi", "MJPG"), std::pair("mkv", "mp4v")),
                         [](const auto& container) { return container.param.first; });

TEST(SequenceRefuses, AVideoThatLostItsIndex) {
  const TempFolder folder;
  WriteVideo(folder / "whole.mp4", "mp4v", 60);
  CopyTruncated(folder / "whole.mp4", folder / "cut.mp4", 0.9);
  EXPECT_THAT(RefusalOf(folder / "cut.mp4"),
              AllOf(HasSubstr("cut.mp4"), HasSubstr("lack its index")));
}

TEST(SequenceOfRealFragmentedVideo, TimestampsIncreaseToTheEndAndATruncatedCopyIsKept) {
  const std::filesystem::path video =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data/theta_walk/theta_walk.mp4";
  if (!std::filesystem::exists(video)) GTEST_SKIP() << video << " is not here";
  const auto sequence = OpenSequence(video.string(), {});
  EXPECT_EQ(sequence->image_size(), cv::Size(640, 322));
  double last = -1.0;
  int count = 0;
  while (const std::optional<Frame> frame = sequence->Next()) {
    EXPECT_NEAR(frame->timestamp, count / 30.0, 2e-3);
    EXPECT_GT(frame->timestamp, last);
    last = frame->timestamp;
    ++count;
  }
  EXPECT_EQ(count, 1202);
  EXPECT_THAT(sequence->TakeWarnings(), IsEmpty());

  const TempFolder folder;
  CopyTruncated(video, folder / "cut.mp4", 0.25);
  const auto cut = OpenSequence((folder / "cut.mp4").string(), {});
  const size_t kept = ReadAll(*cut).size();
  EXPECT_GT(kept, 200u);
  EXPECT_THAT(cut->TakeWarnings(),
              ElementsAre(HasSubstr("frame " + std::to_string(kept) + " of 1202")));
}

TEST(SequenceOptions, StrideStartAndMaximumKeepTheSourcesIndexAndTime) {
  const TempFolder folder;
  WriteVideo(folder / "video.avi", "MJPG", 30);
  SequenceOptions options;
  options.start = 4;
  options.stride = 5;
  const auto sequence = OpenSequence((folder / "video.avi").string(), options);
  EXPECT_EQ(sequence->frame_count(), 6);
  const std::vector<Frame> frames = ReadAll(*sequence);
  EXPECT_THAT(Indices(frames), ElementsAre(4, 9, 14, 19, 24, 29));
  EXPECT_NEAR(frames[1].timestamp, 9 / 25.0, 1e-3);
  EXPECT_NEAR(frames[1].image.at<cv::Vec3b>(2, 2)[0], 40 + 2 * 9, 8);

  options.max_frames = 2;
  EXPECT_THAT(Indices(ReadAll(folder / "video.avi", options)), ElementsAre(4, 9));
}

TEST(SequenceOptions, FrameRateReplacesTheSourcesTimes) {
  const TempFolder folder;
  WriteVideo(folder / "video.avi", "MJPG", 10);
  SequenceOptions options;
  options.fps = 4.0;
  options.stride = 3;
  const std::vector<Frame> frames = ReadAll(folder / "video.avi", options);
  ASSERT_THAT(Indices(frames), ElementsAre(0, 3, 6, 9));
  EXPECT_DOUBLE_EQ(frames[3].timestamp, 9 / 4.0);
}

TEST(SequenceOptions, ResizeScalesEveryImage) {
  const TempFolder folder;
  WriteImages(folder, 2);
  SequenceOptions options;
  options.resize = {64, 32};
  const auto sequence = OpenSequence(folder.path().string(), options);
  EXPECT_EQ(sequence->image_size(), cv::Size(64, 32));
  EXPECT_EQ(sequence->Next()->image.size(), cv::Size(64, 32));
}

TEST(SequenceOfFolder, FollowsTheNumbersInNames) {
  const TempFolder folder;
  WriteImages(folder, 12);
  WriteText(folder / "notes.txt", "not an image");
  WriteText(folder / "._img1.png", "what a file manager left");
  const std::vector<Frame> frames = ReadAll(folder.path());
  ASSERT_THAT(frames, SizeIs(12));
  for (int i = 0; i < 12; ++i) EXPECT_EQ(frames[i].image.at<cv::Vec3b>(2, 2)[0], 40 + 2 * i);
  EXPECT_DOUBLE_EQ(frames[11].timestamp, 11 / 30.0);
}

TEST(SequenceOfFolder, GreySixteenBitAndAlphaBecomeEightBitBgr) {
  const TempFolder folder;
  cv::imwrite((folder / "0.png").string(), cv::Mat(kSize, CV_8UC1, cv::Scalar(77)));
  cv::imwrite((folder / "1.png").string(),
              cv::Mat(kSize, CV_16UC3, cv::Scalar(257 * 10, 257 * 200, 257 * 255)));
  cv::imwrite((folder / "2.png").string(), cv::Mat(kSize, CV_16UC1, cv::Scalar(257 * 99)));
  cv::imwrite((folder / "3.png").string(), cv::Mat(kSize, CV_8UC4, cv::Scalar(1, 2, 3, 128)));
  const std::vector<Frame> frames = ReadAll(folder.path());
  ASSERT_THAT(frames, SizeIs(4));
  for (const Frame& frame : frames) ASSERT_EQ(frame.image.type(), CV_8UC3);
  EXPECT_EQ(frames[0].image.at<cv::Vec3b>(5, 5), cv::Vec3b(77, 77, 77));
  EXPECT_EQ(frames[1].image.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 200, 255));
  EXPECT_EQ(frames[2].image.at<cv::Vec3b>(5, 5), cv::Vec3b(99, 99, 99));
  EXPECT_EQ(frames[3].image.at<cv::Vec3b>(5, 5), cv::Vec3b(1, 2, 3));
}

TEST(SequenceOfFolder, DamagedImagesInTheMiddleAreNamedAndKeepTheirIndex) {
  const TempFolder folder;
  WriteImages(folder, 6);
  cv::imwrite((folder / "whole.jpg").string(), Numbered(4));
  CopyTruncated(folder / "whole.jpg", folder / "img4.jpg", 0.6);
  std::filesystem::remove(folder / "img4.png");
  std::filesystem::remove(folder / "whole.jpg");
  WriteText(folder / "img1.png", "");
  WriteText(folder / "img2.png", "not an image");
  const auto sequence = OpenSequence(folder.path().string(), {});
  const std::vector<Frame> frames = ReadAll(*sequence);
  EXPECT_THAT(Indices(frames), ElementsAre(0, 3, 5));
  EXPECT_THAT(sequence->TakeWarnings(),
              ElementsAre(AllOf(HasSubstr("img1.png"), HasSubstr("0 bytes")),
                          AllOf(HasSubstr("img2.png"), HasSubstr("cannot be decoded")),
                          AllOf(HasSubstr("img4.jpg"), HasSubstr("cut off"))));
}

TEST(SequenceOfFolder, AWarningComesWithTheFrameAfterIt) {
  const TempFolder folder;
  WriteImages(folder, 3);
  WriteText(folder / "img1.png", "");
  const auto sequence = OpenSequence(folder.path().string(), {});
  sequence->Next();
  EXPECT_THAT(sequence->TakeWarnings(), IsEmpty());
  EXPECT_EQ(sequence->Next()->index, 2);
  EXPECT_THAT(sequence->TakeWarnings(), SizeIs(1));
}

TEST(SequenceRefuses, AFolderOfMixedSizesOnOpeningNamingTheFirstAndBothSizes) {
  const TempFolder folder;
  WriteImages(folder, 5);
  cv::imwrite((folder / "img3.png").string(), Numbered(3, {64, 32}));
  EXPECT_THAT(MessageOf<UserError>([&] { OpenSequence(folder.path().string(), {}); }),
              AllOf(HasSubstr("img3.png"), HasSubstr("64x32"), HasSubstr("128x64")));
}

TEST(SequenceRefuses, MixedSizesAlsoWhereTheHeaderTellsNothing) {
  const TempFolder folder;
  for (int i = 0; i < 3; ++i) {
    cv::imwrite((folder / (std::to_string(i) + ".bmp")).string(),
                Numbered(i, i == 2 ? cv::Size(64, 32) : kSize));
  }
  const auto sequence = OpenSequence(folder.path().string(), {});
  EXPECT_TRUE(sequence->Next() && sequence->Next());
  EXPECT_THAT(MessageOf<UserError>([&] { sequence->Next(); }),
              AllOf(HasSubstr("2.bmp"), HasSubstr("64x32")));
}

TEST(SequenceRefuses, WhatIsNotThereOrHoldsNoImage) {
  const TempFolder folder;
  EXPECT_THAT(RefusalOf(folder / "absent.mp4"), HasSubstr("no such file"));
  EXPECT_THAT(RefusalOf(folder.path()), HasSubstr("contains no images"));
  WriteText(folder / "empty.mp4", "");
  EXPECT_THAT(RefusalOf(folder / "empty.mp4"), HasSubstr("0 bytes"));
  WriteText(folder / "text.mp4", "this is no video");
  EXPECT_THAT(RefusalOf(folder / "text.mp4"), HasSubstr("cannot be read as a video"));
  WriteText(folder / "0.png", "");
  WriteText(folder / "1.png", "");
  EXPECT_THAT(RefusalOf(folder.path()), HasSubstr("none of its 2 images"));
  EXPECT_THAT(RefusalOf(folder / "0.png"), HasSubstr("single image"));
}

TEST(SequenceRefuses, AStartBehindTheEnd) {
  const TempFolder folder;
  WriteImages(folder, 3);
  SequenceOptions options;
  options.start = 3;
  EXPECT_THAT(RefusalOf(folder.path(), options), HasSubstr("no frame 3"));
}

TEST(SequenceRefuses, PerspectiveVideoWithTheReason) {
  const TempFolder folder;
  WriteVideo(folder / "wide.avi", "MJPG", 2, 25.0, {192, 108});
  EXPECT_THAT(RefusalOf(folder / "wide.avi"),
              AllOf(HasSubstr("wide.avi"), HasSubstr("192x108"), HasSubstr("not a full sphere")));
}

TEST(SequenceOfDataset, ReadsCameraHeightAndRateAndNothingElse) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "rgb");
  for (int i = 0; i < 3; ++i) {
    cv::imwrite((folder / ("rgb/00000" + std::to_string(i) + ".png")).string(), Numbered(i));
  }
  WriteText(folder / "sequence.yaml",
            "camera: {model: equirectangular}\nfps: 20\ncamera_height: 1.9\nseed: 7\n");
  const auto sequence = OpenSequence(folder.path().string(), {});
  EXPECT_EQ(sequence->camera_height(), 1.9);
  const std::vector<Frame> frames = ReadAll(*sequence);
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_DOUBLE_EQ(frames[2].timestamp, 0.1);

  WriteText(folder / "sequence.yaml", "camera: {model: equirectangular}\n\nfps: fast\n");
  EXPECT_THAT(RefusalOf(folder.path()), HasSubstr("sequence.yaml:3: fps must be"));
  WriteText(folder / "sequence.yaml", "camera: {model: equirectangular}\nfps: 0\n");
  EXPECT_THAT(RefusalOf(folder.path()), HasSubstr("sequence.yaml:2: fps must be"));
  WriteText(folder / "sequence.yaml", "camera: {model: pinhole}\nfps: 20\n");
  EXPECT_THAT(RefusalOf(folder.path()), HasSubstr("camera.model"));
}

TEST(Sequence, CanBeDroppedWhileFramesAreBeingDecoded) {
  const TempFolder folder;
  WriteVideo(folder / "video.avi", "MJPG", 30);
  for (int read = 0; read < 8; ++read) {
    const auto sequence = OpenSequence((folder / "video.avi").string(), {});
    for (int i = 0; i < read; ++i) EXPECT_EQ(sequence->Next()->index, i);
  }
}

TEST(Sequence, GivesOnlyTheFramesThatWereAskedFor) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "images");
  for (int i = 0; i < 12; ++i) {
    cv::imwrite((folder / ("images/" + std::to_string(i) + ".png")).string(), Numbered(i));
  }
  WriteVideo(folder / "video.avi", "MJPG", 12);
  SequenceOptions options;
  options.only = {0, 3, 4, 10, 40};  // The last one is not there.
  for (const char* name : {"images", "video.avi"}) {
    const auto all = ReadAll(*OpenSequence((folder / name).string(), {}));
    const auto frames = ReadAll(*OpenSequence((folder / name).string(), options));
    ASSERT_THAT(frames, SizeIs(4)) << name;
    for (size_t i = 0; i < frames.size(); ++i) {
      const Frame& same = all[static_cast<size_t>(options.only[i])];
      EXPECT_EQ(frames[i].index, options.only[i]);
      EXPECT_EQ(frames[i].timestamp, same.timestamp);
      EXPECT_EQ(cv::norm(frames[i].image, same.image, cv::NORM_INF), 0.0);
    }
  }
}

TEST(Sequence, EndsForGood) {
  const TempFolder folder;
  WriteImages(folder, 1);
  const auto sequence = OpenSequence(folder.path().string(), {});
  EXPECT_TRUE(sequence->Next());
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(sequence->Next());
}

}  // namespace
}  // namespace orb360
