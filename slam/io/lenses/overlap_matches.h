#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/io/lenses/lens_calibration.h"

namespace orb360 {

/// The same thing in the images of both lenses, pixels.
struct LensMatch {
  std::array<Eigen::Vector2d, 2> pixel;
};

/// Finds things that both lenses show. The images, CV_8UC3, are unrolled to rings around the first
/// lens's axis by a calibration that is right to 3 degrees; patches with texture in one ring are
/// searched in the other by normalized correlation, there and back.
std::vector<LensMatch> MatchOverlap(const LensCalibration& calibration,
                                    std::span<const cv::Mat> images);

}  // namespace orb360
