#pragma once

#include <opencv2/core.hpp>

#include "slam/depth/dense_depth.h"

namespace orb360 {

/// A keyframe's picture, its range and its confidence, below each other: CV_8UC3, BGR, each
/// `width` pixels wide. Ranges in the colours of the rainbow by their logarithm, from red for
/// `near` to blue for `far`, black where there is none; confidence from black for 0.5 to white
/// for 1.
cv::Mat DrawDepth(const DenseDepth& depth, double near, double far, int width);

}  // namespace orb360
