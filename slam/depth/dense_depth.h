#pragma once

#include <optional>

#include <opencv2/core.hpp>

namespace orb360 {

/// Dense depth of a keyframe, as completion gives it: equirectangular images of one size.
struct DenseDepth {
  /// CV_32FC1: along each pixel's ray, in the unit of the map when it was made; 0 where unknown.
  cv::Mat range;
  /// CV_32FC1 in 0..1: 1 / confidence - 1 is the relative error to be expected of the range.
  cv::Mat confidence;
  /// CV_8UC3, BGR.
  cv::Mat color;
  /// CV_32FC1 in 0..1: the probability that a pixel shows the ground that the camera moves over;
  /// empty where the network does not tell.
  cv::Mat ground = {};
  /// ln of the camera's height over that ground, in the same unit, as the network takes it from the
  /// whole picture; where it tells.
  std::optional<double> log_camera_height = {};
};

}  // namespace orb360
