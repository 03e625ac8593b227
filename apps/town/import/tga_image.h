#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace orb360::town {

/// Reads an image in Truevision's format (.tga): true colour or grey, 8, 24 or 32 bits a pixel,
/// verbatim or run-length encoded: CV_8UC4, blue first, first row at the top, opaque where it has
/// no alpha. Throws UserError for a file that is damaged or of another kind. Format: "Truevision
/// TGA File Format Specification", version 2.0.
cv::Mat4b ReadTgaImage(const std::filesystem::path& path);

}  // namespace orb360::town
