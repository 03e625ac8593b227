#pragma once

#include <deque>
#include <exception>
#include <filesystem>
#include <future>
#include <optional>

#include <opencv2/core.hpp>

#include "slam/io/image_store.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Chooses the frames of a run whose images dense depth needs, and keeps them on disk. One image at
/// a time is stored beside tracking.
class KeptImages {
 public:
  /// The folder lives as long as the object. Images are reduced to `size`. Those between keyframes
  /// are kept only with `between_keyframes`. Throws UserError if the folder cannot be written.
  KeptImages(const std::filesystem::path& folder, const cv::Size& size, bool between_keyframes)
      : size_(size), between_keyframes_(between_keyframes), store_(folder) {}

  /// Keeps the image (CV_8UC3, BGR) of a frame without a pose, which may get one later. Of those
  /// that follow each other only the first one and the last 100 are kept.
  void KeepUnplaced(int frame_index, const cv::Mat& image);
  /// Keeps the image of a tracked frame, unless the camera has moved by less than a few hundredths
  /// of `median_range`, the surroundings' range, since the last one. The first frame of a map is
  /// always kept.
  void KeepTracked(int frame_index, const cv::Mat& image, const Rigid3& world_from_camera,
                   double median_range);
  /// Keeps the image of a tracked frame that becomes a keyframe.
  void KeepKeyframe(int frame_index, const cv::Mat& image) { Keep(frame_index, image); }
  /// Waits until all images are on disk.
  void Flush();
  /// Removes all images, to make room.
  void Clear() const { store_.Clear(); }

  const ImageStore& store() const { return store_; }
  /// The error because of which images could not be stored, such as a full disk; null where there
  /// was none. All images have been removed then. Contract: Flush has been called.
  std::exception_ptr failure() const { return failure_; }

 private:
  void Keep(int frame_index, const cv::Mat& image);

  const cv::Size size_;
  const bool between_keyframes_;
  std::exception_ptr failure_;
  ImageStore store_;
  std::optional<Eigen::Vector3d> last_place_;  ///< Where the last one was kept, world frame.
  std::optional<int> last_frame_;              ///< The frame whose image was kept last.
  std::deque<int> unplaced_;  ///< Frames without a pose since the last one with a pose.
  /// Stores the newest image. Declared last, so that its thread ends before the store.
  std::future<void> storing_;
};

}  // namespace orb360
