#pragma once

#include <opencv2/core.hpp>

#include <orb360/slam/depth/dense_depth.h>

namespace orb360 {

/// Draws a keyframe's image, its range and its confidence below each other: CV_8UC3, BGR, each
/// `width` pixels wide. Ranges are coloured by their logarithm, from red for `near` to blue for
/// `far`, and are black where there is none. Confidence goes from black for 0.5 to white for 1.
cv::Mat DrawDepth(const DenseDepth& depth, double near, double far, int width);

}  // namespace orb360
