#include "slam/io/lenses/lens_video_source.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/io/lenses/eac.h"
#include "tests/slam/io/lenses/rendered_lens.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/io/video/write_video.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const cv::Size kTrack(2272, 736);

/// Writes a `.360` file, which is an MP4 file.
std::string Write360(const TempFolder& folder, const std::vector<TrackSpec>& tracks) {
  WriteVideoFile(folder / "video.mp4", tracks);
  std::filesystem::rename(folder / "video.mp4", folder / "GS010001.360");
  return (folder / "GS010001.360").string();
}

TrackSpec Gray(const std::vector<int>& values, std::vector<std::int64_t> times = {}) {
  TrackSpec spec;
  for (const int value : values) {
    spec.images.push_back(cv::Mat(kTrack, CV_8UC3, cv::Scalar::all(value)));
  }
  spec.times = std::move(times);
  return spec;
}

TEST(EacVideo, RecordedByAGoProMaxIsStitchedFrameByFrame) {
  const std::filesystem::path data =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data/lens_formats/eac";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is not here";
  std::vector<TrackSpec> tracks(2);
  for (int frame = 1; frame <= 2; ++frame) {
    const std::string name = (data / ("frame" + std::to_string(frame))).string();
    tracks[0].images.push_back(cv::imread(name + "_track0.jpg"));
    tracks[1].images.push_back(cv::imread(name + "_track5.jpg"));
  }
  if (HasEncoder("libx265")) tracks[0].encoder = tracks[1].encoder = "libx265";
  const TempFolder folder;
  const auto sequence = OpenSequence(Write360(folder, tracks), {});
  EXPECT_EQ(sequence->image_size(), cv::Size(4 * 736, 2 * 736));
  for (int frame = 1; frame <= 2; ++frame) {
    const std::optional<Frame> read = sequence->Next();
    ASSERT_TRUE(read);
    const cv::Mat reference =
        cv::imread((data / ("frame" + std::to_string(frame) + "_STITCHED.jpg")).string());
    cv::Mat sphere;
    cv::resize(read->image, sphere, reference.size(), 0, 0, cv::INTER_AREA);
    EXPECT_LT(MedianColorDifference(sphere, reference), 5.0);
    EXPECT_LT(CompareFeatures(sphere, reference).percentile, 0.2);
  }
  EXPECT_FALSE(sequence->Next());
  EXPECT_THAT(sequence->TakeWarnings(), IsEmpty());
}

TEST(EacVideo, FramesOfBothTracksArePairedByTheirTimes) {
  const TempFolder folder;
  // The second track lacks the frame at 40 ms. Both have the same brightness at the same time.
  const std::string path = Write360(
      folder, {Gray({50, 90, 130, 170}, {0, 40, 80, 120}), Gray({50, 130, 170}, {0, 80, 120})});
  const auto sequence = OpenSequence(path, {});
  std::vector<int> indices;
  while (const std::optional<Frame> frame = sequence->Next()) {
    indices.push_back(frame->index);
    const int front = frame->image.at<cv::Vec3b>(736, 1472)[0];
    const int back = frame->image.at<cv::Vec3b>(736, 4)[0];
    EXPECT_NEAR(front, 50 + 1000 * frame->timestamp, 4);
    EXPECT_NEAR(back, front, 4);
  }
  EXPECT_THAT(indices, ElementsAre(0, 1, 2)) << "pairs are counted";
  EXPECT_THAT(sequence->TakeWarnings(), ElementsAre(HasSubstr("1 frames of one lens")));
}

TEST(EacVideo, FramesThatWereAskedForByTheirIndexAreThoseOfARunWithThatIndex) {
  const TempFolder folder;
  const std::string path = Write360(
      folder, {Gray({50, 90, 130, 170}, {0, 40, 80, 120}), Gray({50, 130, 170}, {0, 80, 120})});
  SequenceOptions options;
  options.only = {1, 2};
  const auto sequence = OpenSequence(path, options);
  for (const int value : {130, 170}) {
    const std::optional<Frame> frame = sequence->Next();
    ASSERT_TRUE(frame);
    EXPECT_NEAR(frame->image.at<cv::Vec3b>(736, 1472)[0], value, 4);
  }
}

TEST(EacVideo, ATrackThatStartsLaterIsPairedByTheClockOfTheFile) {
  const TempFolder folder;
  const std::string path = Write360(
      folder, {Gray({50, 90, 130, 170}, {0, 40, 80, 120}), Gray({90, 130, 170}, {40, 80, 120})});
  const auto sequence = OpenSequence(path, {});
  int count = 0;
  while (const std::optional<Frame> frame = sequence->Next()) {
    EXPECT_NEAR(frame->image.at<cv::Vec3b>(736, 4)[0], frame->image.at<cv::Vec3b>(736, 1472)[0], 4);
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST(EacVideo, IsRefusedWithoutItsSecondTrackOrWithAnotherLayout) {
  const TempFolder folder;
  const auto refusal = [&](const std::vector<TrackSpec>& tracks) {
    const std::string path = Write360(folder, tracks);
    return MessageOf<UserError>([&] { OpenSequence(path, {}); });
  };
  EXPECT_THAT(refusal({Gray({1, 2})}),
              AllOf(HasSubstr("GS010001.360"), HasSubstr("one video track")));
  TrackSpec other = Gray({1, 2});
  for (cv::Mat& image : other.images) cv::resize(image, image, {1136, 368});
  EXPECT_THAT(refusal({Gray({1, 2}), other}),
              AllOf(HasSubstr("2272x736 and 1136x368"), HasSubstr("cube faces")));
  WriteText(folder / "VID_1_00_001.insv", "raw");
  EXPECT_THAT(
      MessageOf<UserError>([&] { OpenSequence((folder / "VID_1_00_001.insv").string(), {}); }),
      HasSubstr("--lens insta360"));
  WriteText(folder / "CAM_1_D.OSV", "raw");
  EXPECT_THAT(MessageOf<UserError>([&] { OpenSequence((folder / "CAM_1_D.OSV").string(), {}); }),
              HasSubstr("--lens dji-osmo360"));
  WriteText(folder / "empty.360", "");
  EXPECT_THAT(MessageOf<UserError>([&] { OpenSequence((folder / "empty.360").string(), {}); }),
              HasSubstr("0 bytes"));
}

}  // namespace
}  // namespace orb360
