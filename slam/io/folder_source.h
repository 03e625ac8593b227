#pragma once

#include <filesystem>
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

/// The images of a folder in natural order. Timestamps are index / frame rate. A file that cannot
/// be decoded is skipped with a warning and counts as a frame. Images of different sizes are
/// refused; for JPEG and PNG this happens before the first image is decoded.
class FolderSource : public FrameSource {
 public:
  /// Throws UserError for a folder without images, without an image that can be decoded, or with
  /// images of different sizes. Messages call the input `name`.
  FolderSource(const std::filesystem::path& folder, std::string name,
               double frame_rate = kFolderFrameRate, std::optional<double> camera_height = {});

  const SourceInfo& info() const override { return info_; }
  /// Throws UserError at an image of another size.
  std::optional<Frame> Read() override;
  bool Skip() override;
  std::vector<std::string> TakeWarnings() override { return std::exchange(warnings_, {}); }

 private:
  std::vector<std::filesystem::path> files_;
  SourceInfo info_;
  std::vector<std::string> warnings_;
  size_t next_ = 0;
};

}  // namespace orb360
