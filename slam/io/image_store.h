#pragma once

#include <filesystem>
#include <utility>

#include <opencv2/core.hpp>

#include "slam/io/temporary_folder.h"

namespace orb360 {

/// Images of frames, stored on disk as JPEG while a run lasts. An image of 1024 x 512 pixels takes
/// about 0.2 MB of disk and no memory. Frames are named by their index in the sequence.
///
/// The store has no state besides the files, so different frames may be stored and read on
/// different threads at once.
class ImageStore {
 public:
  /// The folder lives as long as the object. Throws UserError, as Put does, if it cannot be
  /// written.
  explicit ImageStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Stores or replaces an image. Contract: CV_8UC3 (BGR) with at least one pixel.
  void Put(int frame_index, const cv::Mat& image) const;

  bool Contains(int frame_index) const;
  /// Removes an image if it is stored, or all images.
  void Remove(int frame_index) const;
  void Clear() const;

  /// Returns the image (CV_8UC3, BGR). Throws UserError for a frame that is not stored or is
  /// damaged.
  cv::Mat Get(int frame_index) const;
  /// Returns its gray values (CV_8UC1) in half the time.
  cv::Mat GetGray(int frame_index) const;

 private:
  std::filesystem::path PathOf(int frame_index) const;
  cv::Mat Read(int frame_index, int flags) const;

  const TemporaryFolder folder_;
};

}  // namespace orb360
