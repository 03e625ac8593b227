#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace orb360 {

/// True when the name's extension is that of an image format this program reads: JPEG, PNG, BMP,
/// TIFF, WebP, PNM; upper or lower case.
bool IsImageFileName(const std::filesystem::path& path);

/// The size written in the header of a JPEG or PNG file; nullopt for other formats and files whose
/// header is damaged or more than 64 KiB from the start. Reads no more than that.
std::optional<cv::Size> ProbeImageSize(const std::filesystem::path& path);

/// An image, or why there is none.
struct LoadedImage {
  /// CV_8UC3, BGR; empty where `problem` says something.
  cv::Mat image;
  std::string problem;
};

/// Decodes an image file to 8-bit BGR: grey is copied to the three channels, 16 bits a channel are
/// scaled by 255/65535, an alpha channel is dropped, an orientation tag ignored. A file that is
/// empty, cut off or of an unknown kind gives a problem, not an exception.
LoadedImage LoadImage(const std::filesystem::path& path);

}  // namespace orb360
