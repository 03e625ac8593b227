#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/io/lenses/lens_calibration.h"
#include "slam/io/lenses/sphere_stitcher.h"

namespace orb360 {

/// Two lenses expose apart from each other.
inline constexpr bool kMatchesExposure = true;

/// The stitcher for images of two fisheye lenses of those sizes. Throws UserError, whose message
/// begins with `name`, where they do not fit the calibration.
SphereStitcher MakeDualFisheyeStitcher(const LensCalibration& calibration,
                                       const std::vector<cv::Size>& sizes, const std::string& name);

/// The images of two lenses that lie side by side in one, without a copy.
std::vector<cv::Mat> Halves(const cv::Mat& image);

/// Throws UserError where a calibration is not for images with both lenses side by side, which
/// those in a folder are. The message begins with `name`.
void RequireSideBySide(const LensCalibration& calibration, const std::string& name);

}  // namespace orb360
