#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace orb360 {

/// Returns true when the extension of the name is that of a format that this program reads: JPEG,
/// PNG, BMP, TIFF, WebP, PNM, AVIF or HEIC, in upper or lower case.
bool IsImageFileName(const std::filesystem::path& path);

/// Returns the size stated in the header of a JPEG or PNG file. Returns nullopt for other formats,
/// and for files whose header is damaged or more than 64 KiB from the start. Reads no more than
/// that.
std::optional<cv::Size> ProbeImageSize(const std::filesystem::path& path);

/// An image, or the reason why there is none.
struct LoadedImage {
  /// The image, CV_8UC3, BGR; empty if `problem` is not.
  cv::Mat image;
  std::string problem;
};

/// Decodes an image file to 8-bit BGR. Gray is copied to the three channels, 16 bits per channel
/// are scaled by 255/65535, an alpha channel is dropped, and an orientation tag is ignored. A file
/// that is empty, cut off or of an unknown kind gives a problem, not an exception.
LoadedImage LoadImage(const std::filesystem::path& path);

/// Encodes an image of 8 or 16 bits per channel in the format of an extension such as ".jpg". The
/// quality is that of JPEG, 0 to 100. Contract: OpenCV writes this format.
std::string EncodeImage(const std::string& extension, const cv::Mat& image, int jpeg_quality = 95);

/// Writes an image of 8 or 16 bits per channel atomically, encoded by the name's extension
/// (EncodeImage). Throws UserError if the file cannot be written.
void WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace orb360
