#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

namespace orb360 {

/// What a JPEG file says of its image beside the image.
struct JpegMetadata {
  /// The standard XMP packet, XML; empty if there is none.
  std::string xmp;
  /// The content of the first Exif segment, which is a TIFF structure; empty if there is none.
  std::string exif;
};

/// Reads the metadata before the first scan of a JPEG file (ISO 10918-1, annex B; Adobe, XMP part
/// 3; CIPA DC-008). A file that is no JPEG, is damaged, or has none gives empty ones.
JpegMetadata ReadJpegMetadata(std::istream& file);

/// The same of a file by its path.
JpegMetadata ReadJpegMetadata(const std::filesystem::path& path);

/// Returns when an image was taken by the camera's clock, seconds after 1970-01-01 in the camera's
/// time zone (DateTimeOriginal and SubSecTimeOriginal of JpegMetadata::exif), or nullopt if that is
/// absent or not a time.
std::optional<double> ExifTime(std::string_view exif);

}  // namespace orb360
