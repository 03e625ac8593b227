#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace orb360::town {

/// Writes numbers exactly, as an OpenEXR image of one channel, Y, of 32-bit floats, not compressed
/// ("OpenEXR File Layout", version 2, scan lines). Throws UserError if the file cannot be written.
void WriteExrImage(const std::filesystem::path& path, const cv::Mat1f& image);

}  // namespace orb360::town
