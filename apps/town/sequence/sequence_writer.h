#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360::town {

/// Makes sure that a folder can be created, or be written to if it is there, before work is done
/// for it; creates nothing. Throws UserError.
void RequireWritable(const std::filesystem::path& folder);

/// A folder of numbered images with a `sequence.yaml` that says what they are. Files appear under
/// their names only when complete, so that what is there need not be made again.
class SequenceWriter {
 public:
  /// Creates the folder and one for each kind of image, and writes the description; a folder with
  /// another description is refused. Throws UserError.
  SequenceWriter(const std::filesystem::path& folder, const std::string& description,
                 const std::vector<std::string>& kinds);

  const std::filesystem::path& folder() const { return folder_; }
  /// Colour images are JPEG, exact ranges OpenEXR, all others PNG.
  std::filesystem::path ImagePath(const std::string& kind, int frame) const;
  bool Has(const std::string& kind, int frame) const;
  void WriteColour(int frame, const cv::Mat3b& image) const;
  /// Ranges in metres, see WriteDepthImage.
  void WriteRange(int frame, const cv::Mat1f& range) const;
  /// The same as 32-bit floats, see WriteExrImage.
  void WriteExactRange(int frame, const cv::Mat1f& range) const;
  void WriteMask(const std::string& kind, int frame, const cv::Mat& mask) const;
  /// Evenly spread frames of the finished sequence side by side: contact_sheet.jpg.
  void WriteContactSheet(int frames) const;

  static constexpr const char* kColour = "rgb";
  static constexpr const char* kRange = "depth";
  static constexpr const char* kExactRange = "range";
  static constexpr const char* kObjects = "objects";

 private:
  std::filesystem::path folder_;
};

}  // namespace orb360::town
