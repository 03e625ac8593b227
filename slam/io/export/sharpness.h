#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

/// Measures how sharp a panorama (CV_8UC3, BGR) is: the standard deviation of the Laplacian of its
/// gray values, gray levels, where each row counts by its solid angle. Motion blur and a wrong
/// focus lower it; what the image shows changes it as well, so it compares images of the same place
/// only. Images wider than 2048 pixels are reduced to that first, which takes noise away. `mask`
/// (CV_8UC1 of any size, or empty) is 0 where the image does not count.
double MeasureSharpness(const cv::Mat& panorama, const cv::Mat& mask);

}  // namespace orb360
