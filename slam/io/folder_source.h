#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <orb360/slam/io/frame_source.h>

namespace orb360 {

/// Frame rate of an image folder when nothing states it, frames per second.
inline constexpr double kFolderFrameRate = 30.0;

/// Compares names in natural order: runs of digits compare as numbers (img2 before img10), all
/// other characters byte by byte.
bool NaturalLess(std::string_view a, std::string_view b);

/// Returns the image files of a folder in natural order, without hidden ones. Throws UserError,
/// which calls the folder `name`, where there is none.
std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder,
                                              const std::string& name);

/// The images of a folder as frames.
struct FrameList {
  struct Image {
    std::filesystem::path path;
    double timestamp;  ///< Seconds.
  };
  std::vector<Image> images;  ///< In the order of time.
  double frame_rate;          ///< Frames per second; of EXIF times the mean one.
  bool is_reordered;          ///< Whether EXIF times contradict the order of the names.
};

/// Returns the images of ListImages with their times. Without a frame rate, and where all images
/// are JPEG files with EXIF times, these are used: they order the images if the names contradict
/// them, and are the timestamps, from 0, if no two are the same. Otherwise timestamps are index /
/// frame rate (kFolderFrameRate where none is given). Throws UserError as ListImages does.
FrameList ListFrames(const std::filesystem::path& folder, const std::string& name,
                     const std::optional<double>& frame_rate);

/// How the images of a folder become full spheres.
struct SphereMapping {
  cv::Size sphere;   ///< Of the sphere as it is shown, pixels.
  cv::Mat coverage;  ///< As SourceInfo has it.
  std::function<cv::Mat(const cv::Mat& stored)> to_sphere;
};

/// Returns the mapping for images of a size. Throws UserError where they do not fit.
using MakeSphereMapping = std::function<SphereMapping(cv::Size stored)>;

/// The frames of ListFrames; a warning tells where EXIF times contradict the names. Metadata of the
/// namespace GPano that crop the panorama place the images in the full sphere. A file that cannot
/// be decoded is skipped with a warning and counts as a frame. Images of different sizes are
/// refused; for JPEG and PNG this happens before the first image is decoded.
class FolderSource : public FrameSource {
 public:
  /// Throws UserError for a folder without images, without an image that can be decoded, with
  /// images of different sizes or crops, or with images that are no full spheres. Messages call the
  /// input `name`. Without `make_mapping` images are panoramas.
  FolderSource(const std::filesystem::path& folder, std::string name,
               std::optional<double> frame_rate = {}, std::optional<double> camera_height = {},
               const MakeSphereMapping& make_mapping = {});

  const SourceInfo& info() const override { return info_; }
  /// Throws UserError at an image of another size.
  std::optional<Frame> Read() override;
  bool Skip() override;
  std::vector<std::string> TakeWarnings() override { return std::exchange(warnings_, {}); }

 private:
  const FrameList list_;
  cv::Size stored_size_;
  SphereMapping mapping_;
  SourceInfo info_;
  std::vector<std::string> warnings_;
  size_t next_ = 0;
};

}  // namespace orb360
