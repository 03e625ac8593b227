#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

/// Dense depth of a keyframe, as completion gives it: three equirectangular images of one size.
struct DenseDepth {
  /// CV_32FC1: along each pixel's ray, in the unit of the map when it was made; 0 where unknown.
  cv::Mat range;
  /// CV_32FC1 in 0..1: 1 / confidence - 1 is the error to be expected of ln(range).
  cv::Mat confidence;
  /// CV_8UC3, BGR.
  cv::Mat color;
};

}  // namespace orb360
