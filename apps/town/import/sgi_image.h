#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace orb360::town {

/// Reads an image in Silicon Graphics' format (.rgb, .rgba, .bw, .sgi), verbatim or run-length
/// encoded, 8 bits a channel: CV_8UC4, blue first, opaque where it has no alpha. Throws UserError
/// for a file that is damaged or of another kind. Format: "The SGI Image File Format",
/// version 1.00.
cv::Mat4b ReadSgiImage(const std::filesystem::path& path);

}  // namespace orb360::town
