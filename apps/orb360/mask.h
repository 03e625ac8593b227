#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace orb360 {

/// Reads a mask image, black where features are not wanted, and scales it to `size`: CV_8UC1, 0
/// for excluded (darker than half), 255 for the rest. Throws UserError if it cannot be read or is
/// no full sphere.
cv::Mat LoadMask(const std::string& file, cv::Size size);

}  // namespace orb360
