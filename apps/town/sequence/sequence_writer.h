#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360::town {

/// Checks that a folder can be created, or written to if it exists, before work is done for it;
/// creates nothing. Throws UserError.
void RequireWritable(const std::filesystem::path& folder);

/// A folder of numbered images with a `sequence.yaml` that describes them. Files appear under their
/// names only when complete, so existing files need not be made again.
class SequenceWriter {
 public:
  /// Creates the folder and one subfolder for each kind of image, and writes the description. A
  /// folder with another description is refused. Throws UserError.
  SequenceWriter(const std::filesystem::path& folder, const std::string& description,
                 const std::vector<std::string>& kinds);

  const std::filesystem::path& folder() const { return folder_; }
  /// Colour images are JPEG, exact ranges OpenEXR, all others PNG.
  std::filesystem::path ImagePath(const std::string& kind, int frame) const;
  bool Has(const std::string& kind, int frame) const;
  void WriteColour(int frame, const cv::Mat3b& image) const;
  /// Writes ranges in metres (see WriteDepthImage).
  void WriteRange(int frame, const cv::Mat1f& range) const;
  /// Writes the same as 32-bit floats (see WriteExrImage).
  void WriteExactRange(int frame, const cv::Mat1f& range) const;
  void WriteMask(const std::string& kind, int frame, const cv::Mat& mask) const;
  /// Writes contact_sheet.jpg: evenly spaced frames of the finished sequence side by side.
  void WriteContactSheet(int frames) const;

  static constexpr const char* kColour = "rgb";
  static constexpr const char* kRange = "depth";
  static constexpr const char* kExactRange = "range";
  static constexpr const char* kObjects = "objects";

 private:
  std::filesystem::path folder_;
};

}  // namespace orb360::town
