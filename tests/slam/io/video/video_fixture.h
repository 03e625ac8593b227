#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "slam/io/video/video_source.h"
#include "tests/slam/io/temp_folder.h"
#include "tests/slam/io/video/write_video.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

/// Shapes and smooth colours that move with the index.
inline cv::Mat Scene(int index, cv::Size size) {
  cv::Mat image(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.at<cv::Vec3b>(y, x) = cv::Vec3b(cv::saturate_cast<uchar>(255 * x / size.width),
                                            cv::saturate_cast<uchar>(255 * y / size.height),
                                            cv::saturate_cast<uchar>(8 * index));
    }
  }
  cv::circle(image, {size.width / 4 + 3 * index, size.height / 3}, size.height / 6, {20, 240, 90},
             -1);
  return image;
}

inline TrackSpec Scenes(int count, cv::Size size) {
  TrackSpec spec;
  for (int i = 0; i < count; ++i) spec.images.push_back(Scene(i, size));
  return spec;
}

inline TrackSpec Still(const cv::Mat& image) {
  TrackSpec spec;
  spec.images.assign(3, image);
  return spec;
}

/// Four colours, one for each quarter of the image: those of the top row, then those below.
inline cv::Mat Quarters(cv::Size size) {
  cv::Mat image(size, CV_8UC3, cv::Scalar(200, 40, 40));
  const cv::Size half(size.width / 2, size.height / 2);
  image({{half.width, 0}, half}) = cv::Scalar(40, 200, 40);
  image({{0, half.height}, half}) = cv::Scalar(40, 40, 200);
  image({{half.width, half.height}, half}) = cv::Scalar(180, 180, 180);
  return image;
}

/// The number of the quarter, counted as above, that has this colour, or -1.
inline int QuarterOf(const cv::Vec3b& color) {
  const cv::Mat quarters = Quarters({2, 2});
  for (int i = 0; i < 4; ++i) {
    if (cv::norm(cv::Vec3d(color), cv::Vec3d(quarters.at<cv::Vec3b>(i / 2, i % 2))) < 40) return i;
  }
  return -1;
}

class VideoSourceTest : public testing::Test {
 protected:
  std::string Write(const TrackSpec& spec, const std::string& name = "video.mp4") {
    WriteVideoFile(folder_ / name, {spec});
    return (folder_ / name).string();
  }
  std::string Refusal(const TrackSpec& spec) {
    const std::string path = Write(spec);
    return MessageOf<UserError>([&] { VideoSource{path}; });
  }
  TempFolder folder_;
};

inline std::vector<Frame> ReadAll(VideoSource& source) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = source.Read()) frames.push_back(*frame);
  return frames;
}

}  // namespace orb360
