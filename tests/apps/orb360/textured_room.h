#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// A camera carried through a room whose walls are covered with random patches: enough for the
/// system to track, and cheap to draw.
class TexturedRoom {
 public:
  explicit TexturedRoom(cv::Size size) : size_(size) {}

  /// Where the camera is at frame `i`: 4 cm a frame along a gentle curve, looking ahead.
  static Rigid3 WorldFromCamera(int i);
  /// The true poses at so many frames a second.
  static std::vector<StampedPose> Trajectory(int count, double frame_rate);

  /// What it sees at frame `i`: grey, CV_8UC1.
  cv::Mat Draw(int i) const;
  std::vector<cv::Mat> DrawAll(int count) const;

 private:
  cv::Size size_;
};

/// Writes images as `000000.png`... into `folder`, which is made.
void WriteFolder(const std::filesystem::path& folder, const std::vector<cv::Mat>& images,
                 const std::string& extension = ".png");

/// Encodes grey images as Motion JPEG in AVI, 30 frames a second.
void WriteVideo(const std::filesystem::path& path, const std::vector<cv::Mat>& images);

}  // namespace orb360
