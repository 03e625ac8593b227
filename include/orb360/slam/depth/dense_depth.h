#pragma once

#include <optional>

#include <opencv2/core.hpp>

namespace orb360 {

/// Dense depth of a frame: equirectangular images of one size.
struct DenseDepth {
  /// CV_32FC1: range along each pixel's ray, in the unit of the map; 0 where unknown.
  cv::Mat range;
  /// CV_32FC1 in 0..1: 1 / confidence - 1 is the expected relative error of the range.
  cv::Mat confidence;
  /// CV_8UC3, BGR.
  cv::Mat color;
  /// CV_32FC1 in 0..1: probability that a pixel shows the ground over which the camera moves. Empty
  /// if the network does not give it.
  cv::Mat ground = {};
  /// ln of the camera's height over that ground, in the same unit, as the network estimates it from
  /// the whole image, if it does.
  std::optional<double> log_camera_height = {};
};

}  // namespace orb360
